"""Camera pictures of a recording: Foxglove's CompressedImage, taken apart by the wire format of Protocol Buffers."""

from dataclasses import dataclass

from farhand.common.recording.reader import Entry
from farhand.foxglove.wire import fields

_DATA, _FORMAT = 2, 3


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
