"""What is run: the board, its networks and operators, and what a row of it says."""
