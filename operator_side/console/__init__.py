"""The operator's seat in a browser: a program of its own beside the operator's."""
