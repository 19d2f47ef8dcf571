"""A file of one process for readers that want a path: written anew for each input, in memory where there is some."""

import os
import tempfile
from pathlib import Path

MEMORY = Path("/dev/shm")


def scratch(name: str) -> Path:
    """Where an input can be written; the folder goes with the process."""
    where = str(MEMORY) if os.access(MEMORY, os.W_OK) else None
    _kept.append(tempfile.TemporaryDirectory(prefix="farhand-fuzz-", dir=where))
    return Path(_kept[-1].name) / name


_kept: list["tempfile.TemporaryDirectory[str]"] = []
