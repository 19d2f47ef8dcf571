"""How the commands are called here, for lines that are meant to be copied."""

import os
import shutil
import sys
from pathlib import Path

NAME = "farhand"


def called(argv0: str | None = None) -> str:
    """`farhand` where that is found, else the way by which it was started, such as `.venv/bin/farhand`.

    Args:
        argv0: the word by which this program was started; None: this process's own.
    """
    if shutil.which(NAME):
        return NAME
    script = Path(sys.argv[0] if argv0 is None else argv0)
    if script.name == NAME:
        found = os.path.relpath(script)
        return str(script) if found.startswith("..") else found
    return f"{sys.executable} -m {NAME}"
