"""An emulated controller of a UR arm on loopback: ports, programs, an arm in PyBullet, faults on command."""
