"""How often a margin was as large as what it is there for."""
