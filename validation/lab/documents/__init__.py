"""The pictures of the documents: what draws each of them, and what is recorded of each."""
