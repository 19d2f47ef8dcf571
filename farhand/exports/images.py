"""Camera pictures of a recording: Foxglove's CompressedImage, taken apart by the wire format of Protocol Buffers."""

from collections.abc import Iterator
from dataclasses import dataclass

from farhand.common.recording.reader import Entry

_DATA, _FORMAT = 2, 3
VARINT, FIXED64, BYTES, FIXED32 = 0, 1, 2, 5


@dataclass(frozen=True, slots=True)
class Image:
    """Attributes:
    log_ns: its time in the file (ns).
    format: `jpeg`, `png`, `webp`.
    data: the compressed picture.
    """

    log_ns: int
    format: str
    data: bytes


def image_of(entry: Entry) -> Image:
    """A picture; raises ValueError where it is none."""
    form, data = "", b""
    for number, value in fields(entry.data):
        if number == _DATA and isinstance(value, bytes):
            data = value
        elif number == _FORMAT and isinstance(value, bytes):
            form = value.decode()
    if not data:
        raise ValueError("no picture in it")
    return Image(entry.log_ns, form, data)


def fields(message: bytes) -> Iterator[tuple[int, int | bytes]]:
    """The fields of a message in their order: number, and value as written; raises ValueError where it is cut off."""
    at, end = 0, len(message)
    while at < end:
        key, at = _varint(message, at)
        number, kind = key >> 3, key & 7
        if kind == VARINT:
            value, at = _varint(message, at)
            yield number, value
            continue
        if kind == BYTES:
            size, at = _varint(message, at)
        elif kind in (FIXED64, FIXED32):
            size = 8 if kind == FIXED64 else 4
        else:
            raise ValueError(f"a field of kind {kind}")
        if at + size > end:
            raise ValueError("it is cut off")
        yield number, message[at : at + size]
        at += size


def _varint(message: bytes, at: int) -> tuple[int, int]:
    value = shift = 0
    while True:
        if at >= len(message) or shift > 63:
            raise ValueError("it is cut off")
        byte = message[at]
        value |= (byte & 0x7F) << shift
        at += 1
        if byte < 0x80:
            return value, at
        shift += 7
