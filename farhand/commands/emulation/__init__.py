"""Commands about networks: the emulator, its live control, recorded delays."""
