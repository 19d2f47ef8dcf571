"""What a command must pass before it moves anything."""
