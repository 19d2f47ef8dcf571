"""Whether recordings keep what they promise."""
