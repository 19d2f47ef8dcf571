"""What stands and moves around the robot: the truth, and the table of it that compiled code reads."""
