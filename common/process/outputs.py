"""What a program writes beside its work: asked before it runs, and survived where it fails on the way."""

import errno
import fcntl
import os
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from farhand.common.errors import InputError

Written = TypeVar("Written")


def check_writable(path: Path | str | None, option: str) -> None:
    """Raise InputError unless a file can be written there; None and an empty path are none.

    Args:
        path: of the file, which need not exist; its folder must. What is there already stays as it is.
        option: what the user called it, for the message.
    """
    if path is None or path == "":
        return
    try:
        _check_place(Path(path), option)
    except OSError as error:
        raise InputError(f"{option} {path}: cannot be written: {error.strerror or error}") from None


def _check_place(path: Path, option: str) -> None:
    folder = path.resolve().parent
    if not folder.is_dir():
        raise InputError(f"{option} {path}: there is no folder {folder}")
    if path.is_dir():
        raise InputError(f"{option} {path}: is a folder; expected a file")
    if not os.access(path if path.exists() else folder, os.W_OK):
        read_only = os.statvfs(folder).f_flag & os.ST_RDONLY
        why = os.strerror(errno.EROFS) if read_only else "permission denied"
        raise InputError(f"{option} {path}: cannot be written: {why}")
    if not path.exists():
        _try_a_file(folder, f"{option} {path}")


def _try_a_file(folder: Path, what: str) -> None:
    """Raise InputError where a file of one byte finds no place."""
    probe = folder / f".farhand-{os.getpid()}.probe"
    try:
        try:
            probe.write_bytes(b"?")
        finally:
            probe.unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"{what}: cannot be written: {error.strerror or error}") from None


def check_folder(folder: Path | None, option: str) -> None:
    """Raise InputError where a folder cannot be made, before anything is; None is none."""
    if folder is None:
        return
    there = next(each for each in (folder.absolute(), *folder.absolute().parents) if each.exists())
    if not there.is_dir():
        raise InputError(f"{option} {folder}: cannot be written: {there} is no folder")
    if not os.access(there, os.W_OK):
        raise InputError(f"{option} {folder}: cannot be written: permission denied for {there}")


def make_folder(folder: Path, option: str) -> None:
    """Make a folder if need be, and see that files find a place there; raises InputError."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{option} {folder}: cannot be written: {error.strerror or error}") from None
    _try_a_file(folder, f"{option} {folder}")


_held: dict[tuple[int, int], int] = {}
"""Folders that are this process's until it ends, however it ends, by device and inode."""


def hold_folder(folder: Path, option: str) -> None:
    """Have a folder for this process alone until it ends; raises InputError where another program has it.

    The kernel keeps this, so nothing is left behind by a program that was killed. Where a file system cannot
    do it, the folder is used as it is.
    """
    opened = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    found = os.fstat(opened)
    which = found.st_dev, found.st_ino
    if which in _held:
        os.close(opened)
        return
    try:
        fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(opened)
        raise InputError(
            f"{option} {folder}: another run is writing there; wait for its end, or choose another folder"
        ) from None
    except OSError:
        os.close(opened)
        return
    _held[which] = opened


def survive(what: str, write: Callable[[], Written], tell: Callable[[str], None]) -> Written | None:
    """Write something that the run does not depend on; a disk's failure is told in one line, and is None.

    Args:
        what: the option or the file, for the line.
        write: writes it.
        tell: takes the line.
    """
    try:
        return write()
    except OSError as error:
        tell(f"{what}: cannot be written: {error.strerror or error}")
        return None
