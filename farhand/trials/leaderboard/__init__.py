"""The leaderboard: methods against each other on the same tasks, networks and seeds, in virtual time."""
