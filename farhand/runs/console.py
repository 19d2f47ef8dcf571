"""Where tables and lines for people go: a terminal as wide as it is, or a file whose lines do not wrap."""

import os
import sys

from rich.console import Console

FILE_WIDTH = 4096


def page(*, stderr: bool = False) -> Console:
    """A console on stdout, or on stderr; `COLUMNS` says how wide, as everywhere."""
    file = sys.stderr if stderr else sys.stdout
    chosen = os.environ.get("COLUMNS", "").isdigit()
    return Console(file=file) if file.isatty() or chosen else Console(file=file, width=FILE_WIDTH)
