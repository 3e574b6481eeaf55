"""Draw the documents' images, and record what each was drawn with."""
