"""One small file for each format of delay traces: `matches(text)` and `read(text, options) -> Samples`.

To add one: write the file, and register it in READERS, the most particular first.
"""

from collections.abc import Callable

from farhand.netem.recordings.formats import cicv5g, csv_text, irtt, ping, slots
from farhand.netem.recordings.formats.base import ReadOptions, Samples, TraceText

READERS: dict[str, tuple[Callable[[TraceText], bool], Callable[[TraceText, ReadOptions], Samples]]] = {
    "cicv5g": (cicv5g.matches, cicv5g.read),
    "irtt": (irtt.matches, irtt.read),
    "ping": (ping.matches, ping.read),
    "csv": (csv_text.matches, csv_text.read),
    "slots": (slots.matches, slots.read),
}
