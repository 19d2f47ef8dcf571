"""`farhand runs`: the runs that lie in a folder, and those that may go."""
