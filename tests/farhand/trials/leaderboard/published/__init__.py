"""What docs/leaderboard.md publishes, and that it is what the rows beside it say."""
