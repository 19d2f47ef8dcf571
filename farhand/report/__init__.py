"""The report of a recorded run: one page that opens anywhere, and the same as JSON."""
