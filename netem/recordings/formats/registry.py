"""The formats of delay traces: those of Farhand, one line each, and those that installed packages bring.

Which format a file has is asked in this order: what is particular (cicv5g, irtt, fping, hping3, ping), the formats of
packages by their names, and last what is general (csv, slots).
"""

from farhand.common.errors import InputError, TraceError
from farhand.common.kinds import Kinds
from farhand.netem.recordings.formats.base import TraceFormat, TraceText

_HERE = "farhand.netem.recordings.formats"
FORMATS: Kinds[type[TraceFormat]] = Kinds(
    "trace format",
    "farhand.trace_formats",
    TraceFormat,
    {
        "cicv5g": f"{_HERE}.cicv5g:Cicv5g",
        "irtt": f"{_HERE}.irtt:Irtt",
        "fping": f"{_HERE}.fping:Fping",
        "hping3": f"{_HERE}.hping3:Hping3",
        "ping": f"{_HERE}.ping:Ping",
        "csv": f"{_HERE}.csv_text:CsvText",
        "slots": f"{_HERE}.slots:Slots",
    },
)


def format_called(name: str, where: str) -> TraceFormat:
    """The format of a name; raises TraceError, which begins with `where`."""
    try:
        return FORMATS.get(name, "format")()
    except InputError as error:
        raise TraceError(f"{where}: {error}") from None


def format_of(text: TraceText) -> TraceFormat:
    """The first format that a text looks like; raises TraceError if there is none."""
    formats = [format_called(name, f"trace {text.name}") for name in FORMATS.names()]
    for each in sorted(formats, key=lambda known: known.general):
        if each.matches(text):
            return each
    line = next(index for index, content in enumerate(text.lines, start=1) if content.strip())
    text.fail(f"unknown format, {text.excerpt(line)}; one of {', '.join(FORMATS.names())}", line)
