"""The folder that an export makes: whole or not at all, and never over something that is no export."""

import errno
import importlib.util
import os
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from farhand.common.errors import InputError

MARKS = ("columns.csv", "metadata.yaml", "*/metadata.yaml", "meta/info.json")
"""What an export's folder holds, by which one knows it."""
FULL = {errno.ENOSPC, errno.EDQUOT}


def need(packages: Sequence[str], form: str) -> None:
    """Raise InputError where packages are not installed."""
    absent = [name for name in packages if importlib.util.find_spec(name) is None]
    if absent:
        raise InputError(
            f"--to {form}: {', '.join(absent)} not installed; expected what `pip install 'farhand[export]'` brings"
        )


@contextmanager
def whole_folder(out: Path, *, force: bool) -> Iterator[Path]:
    """A folder to write into, which takes the place of `out` at the end, and is gone where that is not reached.

    Args:
        out: must not be there, be empty, or, with `force`, be an export.
        force: replace it.

    Raises:
        InputError: it is there already, or cannot be written.
        OSError: the disk is full on the way; it names `out`.
    """
    _check_free(out, force=force)
    parent = out.resolve().parent
    stage = parent / f".{out.resolve().name}.farhand-{os.getpid()}"
    inner = stage / out.resolve().name  # of the same name, as some formats name files after their folder
    try:
        parent.mkdir(parents=True, exist_ok=True)
        inner.mkdir(parents=True)
    except OSError as error:
        raise InputError(f"--out {out}: cannot be written: {error.strerror or error}") from None
    try:
        yield inner
        _take_place(inner, out)
    except OSError as error:
        if error.errno in FULL and error.filename is None:
            error.filename = str(out)  # of a write, which names no file
        raise
    finally:
        shutil.rmtree(stage, ignore_errors=True)


def _check_free(out: Path, *, force: bool) -> None:
    if not out.exists() and not out.is_symlink():
        return
    if not out.is_dir():
        raise InputError(f"--out {out}: is a file; expected a folder that is not there yet")
    if not any(out.iterdir()):
        return
    ours = any(any(out.glob(mark)) for mark in MARKS)
    if not ours:
        raise InputError(f"--out {out}: holds other things; choose another folder")
    if not force:
        raise InputError(
            f"--out {out}: holds an export already; choose another folder, or --force to replace it"
        )


def _take_place(made: Path, out: Path) -> None:
    if out.exists():
        out.rename(made.with_name(f"{made.name}.old"))  # goes with the stage
    made.rename(out)
