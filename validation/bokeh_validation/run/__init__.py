"""Run the brief and the full validation, and write their report."""
