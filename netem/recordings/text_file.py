"""A text file cut into lines, whatever it is packed or encoded in, with one clear error for what is none.

Read are UTF-8, UTF-16 (told by its mark, or by its zero bytes), and each of them within gzip. A ping that is neither
is one of a Windows terminal, whose letters do not matter, and read byte by byte. What is larger than MAX_BYTES stays
on the disk and is read line by line, up to MAX_STREAMED.
"""

import codecs
import gzip
import re
import tempfile
import weakref
import zlib
from array import array
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO, overload

from farhand.common.errors import TraceError
from farhand.netem.recordings.formats.base import TraceText

MAX_BYTES = 256_000_000
"""Of text that is held in memory; more is read from the disk."""
MAX_STREAMED = 8_000_000_000
"""Of text at all, unpacked."""
_CHUNK = 1 << 20
_PING = re.compile(rb"[=<] ?[0-9.,]+ ?ms")
_GZIP = b"\x1f\x8b"


def read_text(path: str | Path) -> TraceText:
    """The lines of a text file; raises TraceError if it cannot be read, is empty or is no text."""
    name = str(path)
    notes: list[str] = []
    try:
        with open(path, "rb") as file:
            packed = file.read(2) == _GZIP
            file.seek(0)
            content, rest = _first(_unpacked(file, notes) if packed else _chunks(file))
            if rest is None:
                text = _held(name, content)
            else:
                text = _streamed(name, content, rest)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise TraceError(f"trace {name}: cannot be read: {reason}") from None
    if packed:
        text.how("packed", "gzip")
    for note in notes:
        text.say(note)
    return text


def _chunks(file: IO[bytes]) -> Iterator[bytes]:
    while chunk := file.read(_CHUNK):
        yield chunk


def _unpacked(file: IO[bytes], notes: list[str]) -> Iterator[bytes]:
    try:
        with gzip.GzipFile(fileobj=file) as unpacked:
            # Byte by byte of what is asked for: a file that was cut off gives all that is there.
            while chunk := unpacked.read1(_CHUNK):
                yield chunk
    except (EOFError, zlib.error, gzip.BadGzipFile):
        notes.append("the packed file is cut off or damaged: read up to there")


def _first(chunks: Iterator[bytes]) -> tuple[bytes, Iterator[bytes] | None]:
    """All of it, or the first MAX_BYTES and more, and the rest."""
    parts: list[bytes] = []
    size = 0
    for chunk in chunks:
        parts.append(chunk)
        size += len(chunk)
        if size > MAX_BYTES:
            return b"".join(parts), chunks
    return b"".join(parts), None


def _encoding(content: bytes) -> str:
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    head = content[:200]
    for name, zeros in (("utf-16-le", head[1::2]), ("utf-16-be", head[::2])):
        if len(zeros) > 1 and 10 * zeros.count(0) > 9 * len(zeros):
            return name
    return "utf-8-sig"


def _held(name: str, content: bytes) -> TraceText:
    encoding = _encoding(content)
    try:
        decoded = content.decode(encoding)
    except UnicodeDecodeError as error:
        if encoding != "utf-8-sig" or not _PING.search(content[:_CHUNK]):
            line = content.count(b"\n", 0, error.start) + 1
            raise TraceError(f"trace {name}, line {line}: not text (UTF-8 or UTF-16)") from None
        encoding, decoded = (
            "latin-1 (no UTF-8; letters may be wrong, numbers are not)",
            content.decode("latin-1"),
        )
    text = TraceText(name, decoded.replace("\r\n", "\n").replace("\r", "\n").split("\n"))
    if "\0" in decoded:
        text.fail("not text: a zero byte", decoded.count("\n", 0, decoded.index("\0")) + 1)
    if not decoded.strip():
        text.fail("the file is empty")
    if encoding != "utf-8-sig":
        text.how("encoding", encoding)
    return text


def _streamed(name: str, content: bytes, rest: Iterator[bytes]) -> TraceText:
    encoding = _encoding(content)
    # The lines own the file, which is gone when they are.
    lines = _LinesOnDisk(name, tempfile.TemporaryFile())  # noqa: SIM115
    decode = codecs.getincrementaldecoder(encoding)()
    try:
        lines.append(decode.decode(content))
        for chunk in rest:
            lines.append(decode.decode(chunk))
        lines.append(decode.decode(b"", final=True))
    except UnicodeDecodeError:
        raise TraceError(f"trace {name}, line {len(lines)}: not text (UTF-8 or UTF-16)") from None
    text = TraceText(name, lines)
    text.how("size", f"{lines.size / 1e6:.0f} MB, read line by line")
    return text


class _LinesOnDisk(Sequence[str]):
    """Lines of a text that is too large to hold, read one after the other."""

    def __init__(self, name: str, file: IO[bytes]) -> None:
        self._name = name
        self._file = file
        weakref.finalize(self, file.close)
        self._starts = array("q", [0])
        self._from, self._block = 0, b""
        self.size = 0

    def append(self, text: str) -> None:
        """More of the text."""
        content = text.encode()
        if self.size + len(content) > MAX_STREAMED:
            raise TraceError(f"trace {self._name}: larger than {MAX_STREAMED // 1_000_000_000} GB")
        at = content.find(b"\n")
        while at >= 0:
            self._starts.append(self.size + at + 1)
            at = content.find(b"\n", at + 1)
        self._file.write(content)
        self.size += len(content)

    def __len__(self) -> int:
        return len(self._starts)

    @overload
    def __getitem__(self, index: int) -> str: ...
    @overload
    def __getitem__(self, index: slice) -> list[str]: ...
    def __getitem__(self, index: int | slice) -> str | list[str]:
        if isinstance(index, slice):
            return [self[place] for place in range(*index.indices(len(self)))]
        place = index + len(self) if index < 0 else index
        if not 0 <= place < len(self):
            raise IndexError(index)
        start = self._starts[place]
        end = self._starts[place + 1] - 1 if place + 1 < len(self) else self.size
        if not (self._from <= start and end <= self._from + len(self._block)):
            self._file.seek(start)
            self._from, self._block = start, self._file.read(max(_CHUNK, end - start))
        return self._block[start - self._from : end - self._from].decode().rstrip("\r")
