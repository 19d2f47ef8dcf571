"""The emulated network: a proxy between operator and robot."""
