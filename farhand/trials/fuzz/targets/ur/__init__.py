"""A UR's controller, and who talks to it."""
