"""What the emulator did, counted and written down."""
