"""A run: its results, summary, report, figure and folder."""
