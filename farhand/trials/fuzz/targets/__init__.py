"""One file an edge: what goes in, what must never come of it."""
