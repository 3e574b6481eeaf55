"""One listing in three languages: shader text read, brought to a common form and laid side by side. See parity.py."""
