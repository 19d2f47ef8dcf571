"""What breaks around a UR arm: each fault once, in the emulator, while the arm moves."""
