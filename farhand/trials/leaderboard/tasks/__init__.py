"""What is to be done: scenes, and tasks drawn from them that can be done."""
