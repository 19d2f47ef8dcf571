"""Recorded runs: writing and reading."""
