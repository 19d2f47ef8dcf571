"""Clocks, periods, and the loop that calls a node."""
