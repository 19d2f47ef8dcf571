"""TOML, read in one way everywhere: what is wrong with a text is one line that names the file and the line."""

import re
import sys
from pathlib import Path
from typing import Any

from farhand.common.errors import InputError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

MAX_BYTES = 16_000_000
_PLACE = re.compile(r" ?\(at (?:line (\d+), column (\d+)|end of document)\)\Z")


def read_toml(path: str | Path, what: str, error: type[InputError] = InputError) -> dict[str, Any]:
    """The table in a TOML file.

    Args:
        path: the file; UTF-8, with or without a byte-order mark.
        what: what the file is, the first word of an error, e.g. "timeline".
        error: what to raise.

    Raises:
        error: it cannot be read, is no text, or is not valid TOML; one line.
    """
    try:
        with open(path, "rb") as file:
            content = file.read(MAX_BYTES + 1)
    except (OSError, ValueError) as reason:
        why = reason.strerror if isinstance(reason, OSError) and reason.strerror else str(reason)
        raise error(f"{what} {path}: cannot be read: {why}") from None
    if len(content) > MAX_BYTES:
        raise error(f"{what} {path}: larger than {MAX_BYTES // 1_000_000} MB")
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as reason:
        line = content.count(b"\n", 0, reason.start) + 1
        raise error(f"{what} {path}, line {line}: cannot be read: is not UTF-8 text") from None
    return parse_toml(text, f"{what} {path}", error)


def parse_toml(text: str, where: str, error: type[InputError] = InputError) -> dict[str, Any]:
    """The table in a TOML text; `where` names it in an error, e.g. "timeline lab.toml"."""
    try:
        return tomllib.loads(text.removeprefix("\ufeff"))
    except RecursionError:
        raise error(f"{where}: not valid TOML: nested too deeply") from None
    except ValueError as reason:  # tomllib's own errors, and numbers of too many digits
        problem = " ".join(str(reason).split())
        place = _PLACE.search(problem)
        if place is None:
            raise error(f"{where}: not valid TOML: {problem}") from None
        line, column = place.groups()
        at = f": line {line or text.count(chr(10)) + 1}" + (f", column {column}" if column else "")
        raise error(f"{where}{at}: not valid TOML: {problem[: place.start()]}") from None
