"""What is wrong on the path to a robot, and what to do about it."""
