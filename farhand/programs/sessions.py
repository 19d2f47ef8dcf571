"""What identifies one start of a program."""

import secrets


def random_session() -> int:
    """A session for one start of a program; never 0."""
    return secrets.randbelow((1 << 62) - 1) + 1
