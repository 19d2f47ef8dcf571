"""What was asked in a recorded run, asked again."""
