"""A real UR arm: its controller's protocols, the program that runs there, and what stops it."""
