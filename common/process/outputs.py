"""Whether a program will be able to write what it was told to, asked before it runs."""

import os
from pathlib import Path

from farhand.common.errors import InputError


def check_writable(path: Path | str | None, option: str) -> None:
    """Raise InputError unless a file can be written there; None and an empty path are none.

    Args:
        path: of the file, which need not exist; its folder must.
        option: what the user called it, for the message.
    """
    if path is None or path == "":
        return
    path = Path(path)
    folder = path.resolve().parent
    if not folder.is_dir():
        raise InputError(f"{option} {path}: there is no folder {folder}")
    if path.is_dir():
        raise InputError(f"{option} {path}: is a folder; expected a file")
    if not os.access(path if path.exists() else folder, os.W_OK):
        raise InputError(f"{option} {path}: cannot be written: permission denied")
