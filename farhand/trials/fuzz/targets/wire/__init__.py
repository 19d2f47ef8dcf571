"""Messages between programs that may be on other hosts."""
