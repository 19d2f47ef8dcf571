"""An emulated controller of a UR arm on loopback: its ports, its programs, its arm in PyBullet, its faults on command."""
