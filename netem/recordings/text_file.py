"""A text file cut into lines, with one clear error for what is none."""

from pathlib import Path

from farhand.common.errors import TraceError
from farhand.netem.recordings.formats.base import TraceText

MAX_BYTES = 256_000_000


def read_text(path: str | Path) -> TraceText:
    """The lines of a text file; raises TraceError if it cannot be read, is empty or is no text."""
    name = str(path)
    try:
        with open(path, "rb") as file:
            content = file.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise TraceError(f"trace {name}: cannot be read: {reason}") from None
    if len(content) > MAX_BYTES:
        raise TraceError(f"trace {name}: larger than {MAX_BYTES // 1_000_000} MB")
    try:
        decoded = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise TraceError(f"trace {name}, line {line}: not text (UTF-8)") from None
    text = TraceText(name, decoded.replace("\r\n", "\n").replace("\r", "\n").split("\n"))
    if "\0" in decoded:
        text.fail("not text: a zero byte", decoded.count("\n", 0, decoded.index("\0")) + 1)
    if not decoded.strip():
        text.fail("the file is empty")
    return text
