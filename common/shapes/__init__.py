"""Shapes of obstacles."""
