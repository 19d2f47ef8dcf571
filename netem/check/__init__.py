"""The emulator asked whether it did what it drew."""
