"""Robots: one small file each, and their registry."""
