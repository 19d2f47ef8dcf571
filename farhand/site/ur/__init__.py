"""A real UR arm's site tools: what is wrong with it, and how it is brought back."""
