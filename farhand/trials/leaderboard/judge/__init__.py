"""What is true of a run: distances, what could have been evaded, smoothness."""
