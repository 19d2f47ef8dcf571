"""URDF and SRDF: what an arm is, read from files."""
