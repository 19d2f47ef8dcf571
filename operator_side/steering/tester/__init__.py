"""The task by itself: to the targets, around what is in the way."""
