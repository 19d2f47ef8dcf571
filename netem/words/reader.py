"""Reads the text of a SPEC piece by piece; every error points at a character."""

import re
from typing import NoReturn

from farhand.common.errors import SpecError
from farhand.common.timing.clock import to_seconds

MAX_DELAY_NS = 3_600_000_000_000
MAX_DURATION_NS = 1000 * 3_600_000_000_000
MAX_TEXT = 4096
DEFAULT_QUEUE = 256_000
"""Bytes in the queue of a rate limit, where none is given."""

_NUMBER = re.compile(r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?")
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]*")
_TIME_UNIT = re.compile(r"(us|ms|s|min)(?![A-Za-z])")
_RATE_UNIT = re.compile(r"(bit|kbit|mbit|gbit)(?![A-Za-z])", re.IGNORECASE)
_SIZE_UNIT = re.compile(r"(B|kB|MB)(?![A-Za-z])", re.IGNORECASE)
_TIME_NS = {"us": 1e3, "ms": 1e6, "s": 1e9, "min": 60e9}
_RATES = {"bit": 1.0, "kbit": 1e3, "mbit": 1e6, "gbit": 1e9}
_SIZES = {"b": 1.0, "kb": 1e3, "mb": 1e6}


class SpecReader:
    """A cursor over the text of one SPEC.

    Args:
        text: the whole SPEC.

    Attributes:
        position: of the next character.
        word: name of the word whose parameters are being read.
        example: what would be right, for errors.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        self.position = 0
        self.word = ""
        self.example = ""

    def fail(self, problem: str, position: int | None = None) -> NoReturn:
        """Raise SpecError at `position` (default: here)."""
        place = (self.position if position is None else position) + 1
        shown = self.text if len(self.text) <= 120 else self.text[:117] + "..."
        example = f", e.g. {self.example}" if self.example else ""
        raise SpecError(f'network "{_printable(shown)}": at character {place}: {problem}{example}')

    def rest(self) -> str:
        """What has not been read."""
        return self.text[self.position :]

    def skip_space(self) -> None:
        """Go to the next character that is not white space."""
        while self.position < len(self.text) and self.text[self.position].isspace():
            self.position += 1

    def at_end(self) -> bool:
        """Whether everything has been read."""
        return self.position >= len(self.text)

    def take(self, literal: str) -> bool:
        """Read `literal` if it is next."""
        if self.text.startswith(literal, self.position):
            self.position += len(literal)
            return True
        return False

    def expect(self, literal: str, what: str) -> None:
        """Read `literal`; `what` says what should follow it."""
        if not self.take(literal):
            self.fail(f"expected '{literal}'" + (f" and {what}" if what else ""))

    def name(self) -> str:
        """Read a name; empty if none is next."""
        match = _NAME.match(self.text, self.position)
        if match is None:
            return ""
        self.position = match.end()
        return match.group()

    def number(self, what: str) -> float:
        """Read a number >= 0."""
        match = _NUMBER.match(self.text, self.position)
        if match is None:
            if self.text.startswith("-", self.position):
                self.fail(f"{what} cannot be negative")
            self.fail(f"expected {what}")
        value = float(match.group())
        if value > 1e15:
            self.fail(f"{what} is too large")
        self.position = match.end()
        return value

    def duration_ns(self, what: str, largest_ns: int = MAX_DELAY_NS) -> int:
        """Read a duration: a number of ms, or one with a unit (us, ms, s, min)."""
        start = self.position
        value = self.number(what)
        if self.take("%"):
            self.fail(f"{what} is a time, not a percentage", start)
        match = _TIME_UNIT.match(self.text, self.position)
        if match is not None:
            self.position = match.end()
        found_ns = round(value * _TIME_NS[match.group() if match else "ms"])
        if found_ns > largest_ns:
            self.fail(f"{what} is longer than {largest_ns // 1_000_000_000} s", start)
        return found_ns

    def probability(self, what: str, *, one_is_clear: bool = False) -> float:
        """Read a probability: a percentage with its sign, or a fraction of 1 without.

        A bare 1 is refused unless `one_is_clear`: who writes it may mean 1%, or all.
        """
        start = self.position
        value = self.number(what)
        is_bare = not self.take("%")
        if not is_bare:
            value = round(value, 10) / 100
        if value > 1:
            self.fail(f"{what} is above 1 (write 5% or 0.05)", start)
        if is_bare and value == 1 and not one_is_clear:
            self.fail(f"{what} is a bare 1: write 1%, or 100% for all", start)
        return round(value, 12)

    def correlation(self, what: str = "the correlation") -> float:
        """Read a correlation: a percentage below 100%."""
        start = self.position
        value = self.probability(what)
        if value >= 1:
            self.fail(f"{what} must be below 100%", start)
        return value

    def optional_correlation(self) -> float:
        """Read `,25%` if it is there; 0 otherwise."""
        return self.correlation() if self.take(",") else 0.0

    def rate(self, what: str) -> int:
        """Read a rate with its unit: bit/s."""
        start = self.position
        value = self.number(what)
        match = _RATE_UNIT.match(self.text, self.position)
        if match is None:
            self.fail("expected the rate's unit: bit, kbit, mbit or gbit")
        self.position = match.end()
        found = round(value * _RATES[match.group().lower()])
        if found <= 0:
            self.fail(f"{what} must be above 0 (an outage is outage:every(...))", start)
        return found

    def size(self, what: str) -> int:
        """Read a size with its unit: bytes."""
        start = self.position
        value = self.number(what)
        match = _SIZE_UNIT.match(self.text, self.position)
        if match is None:
            self.fail("expected the size's unit: B, kB or MB")
        self.position = match.end()
        found = round(value * _SIZES[match.group().lower()])
        if found <= 0:
            self.fail(f"{what} must be above 0", start)
        return found

    def optional_size(self) -> int:
        """Read a size if one with its unit is next; 0 otherwise."""
        number = _NUMBER.match(self.text, self.position)
        if number is None or _SIZE_UNIT.match(self.text, number.end()) is None:
            return 0
        return self.size("the size")

    def count(self, what: str) -> int:
        """Read a whole number >= 1."""
        start = self.position
        value = self.number(what)
        if value != int(value) or not 1 <= value <= 1_000_000_000:
            self.fail(f"{what} must be a whole number from 1 on", start)
        return int(value)

    def path(self, what: str) -> str:
        """Read a file name: in double quotes, or up to white space, a comma or a closing bracket."""
        if self.take('"'):
            end = self.text.find('"', self.position)
            if end < 0:
                self.fail("the quotation mark is not closed", self.position - 1)
        else:
            end = self.position
            while end < len(self.text) and not (self.text[end].isspace() or self.text[end] in ',")]['):
                end += 1
        found = self.text[self.position : end]
        if not found or "\0" in found:
            self.fail(f"expected {what}")
        self.position = end + (1 if self.text[end : end + 1] == '"' else 0)
        return found


def path_text(path: str) -> str:
    """A file name as `SpecReader.path` reads it."""
    plain = not any(character.isspace() or character in ',")][' for character in path)
    return path if plain else f'"{path}"'


def number_text(value: float) -> str:
    """A number in its shortest form."""
    return str(int(value)) if value == int(value) and abs(value) < 1e15 else repr(value)


def milliseconds_text(duration_ns: int) -> str:
    """A duration as a plain number of ms."""
    return number_text(round(duration_ns / 1e6, 6))


def seconds_text(duration_ns: int) -> str:
    """A duration in s with its unit, or in ms where that is shorter."""
    if duration_ns % 1_000_000_000 and duration_ns < 1_000_000_000:
        return milliseconds_text(duration_ns) + "ms"
    return number_text(round(to_seconds(duration_ns), 9)) + "s"


def percent_text(probability: float) -> str:
    """A probability as a percentage."""
    return number_text(round(probability * 100, 10)) + "%"


def _printable(text: str) -> str:
    return "".join(c if c.isprintable() else " " if c.isspace() else "?" for c in text)
