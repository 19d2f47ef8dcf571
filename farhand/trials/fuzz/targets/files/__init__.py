"""What is read before a run, or after it."""
