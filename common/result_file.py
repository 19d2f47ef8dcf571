"""What a program leaves behind at its end: one JSON file that says in which version it is written, and by whom.

A result is a Struct with the fields `version` and `written_by`. A field that is added later has a default, and
the version stays; when the meaning of one changes, or one goes, the version rises.
"""

import importlib.metadata
import os
from functools import cache
from pathlib import Path
from typing import TypeVar

import msgspec

from farhand.common.errors import ResultError

Kind = TypeVar("Kind", bound=msgspec.Struct)


@cache
def this_program() -> str:
    """`farhand 0.2.0`, as installed: read once, as a short task in virtual time takes little longer than reading it."""
    try:
        return f"farhand {importlib.metadata.version('farhand')}"
    except importlib.metadata.PackageNotFoundError:
        return "farhand"


class _Header(msgspec.Struct):
    version: int
    written_by: str = "an unknown program"


def write_result(result: msgspec.Struct, path: Path) -> None:
    """Write a result: whole or not at all, where that can be; a pipe or a device gets it as it is."""
    write_whole(path, msgspec.json.format(msgspec.json.encode(result), indent=-1) + b"\n")


def write_whole(path: Path, content: bytes | str) -> None:
    """Write a file: whole or not at all, where that can be; a pipe or a device gets it as it is.

    Raises OSError where it cannot be; what was there before is there still, and nothing else.
    """
    data = content.encode() if isinstance(content, str) else content
    path = path.resolve()
    if path.exists() and not path.is_file():
        path.write_bytes(data)
        return
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        try:
            part.write_bytes(data)
            os.replace(part, path)
        finally:
            part.unlink(missing_ok=True)
    except PermissionError:  # the file is to be had, its folder is not
        path.write_bytes(data)


def read_result(path: Path, kind: type[Kind]) -> Kind | None:
    """The result in a file; None where there is no file.

    Raises ResultError with one line where it is broken, or of another version.
    """
    try:
        text = path.read_bytes()
    except FileNotFoundError:
        return None
    except OSError as error:
        raise ResultError(f"{path}: cannot be read: {error.strerror}") from None
    known = next(each.default for each in msgspec.structs.fields(kind) if each.name == "version")
    try:
        header = msgspec.json.decode(text, type=_Header)
        if header.version != known:
            raise ResultError(
                f"{path}: is of version {header.version}, written by {header.written_by}; this is "
                f"{this_program()}, which reads version {known}"
            )
        return msgspec.json.decode(text, type=kind)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise ResultError(f"{path}: is not what a program left at its end: {error}") from None
