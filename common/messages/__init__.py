"""What travels between the programs, and how it is written."""
