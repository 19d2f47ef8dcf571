"""Safety filters behind one interface."""
