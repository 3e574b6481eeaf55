"""The brief and the full run, and their report."""
