"""What a lens sees, and how near each method comes to it."""
