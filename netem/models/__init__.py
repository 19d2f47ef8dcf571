"""Seeded models of a network's delay, fitted and named."""
