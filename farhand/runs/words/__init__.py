"""What happened to a run and why, in words for people, and quantities as they read them."""
