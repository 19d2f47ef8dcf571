"""Capsules fitted to what a URDF says of its links' shapes; asked for by a command, never by a running robot."""
