"""How the text of a SPEC is read."""
