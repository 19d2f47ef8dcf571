"""The command line: options and what they call. Nothing is decided here."""
