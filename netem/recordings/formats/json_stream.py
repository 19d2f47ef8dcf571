"""Reads a large JSON object piece by piece: a value at a time, an array's items one after the other."""

import json
import re
from collections.abc import Iterator, Sequence
from typing import Any

PIECE = 1 << 20
"""Characters that are read at once."""
LARGEST_VALUE = 64 << 20
"""Of one value that is not an array's item on its own (characters)."""
_AFTER = tuple(" \t\r\n,:]}")
_HALF_NUMBER = re.compile(r"(\.|[eE][+-]?)\s*\Z")
_HALF_ESCAPE = re.compile(r"(\\|u[0-9a-fA-F]{0,3})\Z")
_LITERALS = ("true", "false", "null", "-")


class JsonError(ValueError):
    """The text is no JSON, or not of the form that is read."""


class CutOffError(JsonError):
    """The text ends within a value."""


class JsonStream:
    """A cursor over the lines of a JSON text; holds little more than the value that is being read.

    Args:
        lines: of the text, without line ends.
    """

    def __init__(self, lines: Sequence[str]) -> None:
        self._lines = iter(lines)
        self._buffer = ""
        self._at = 0
        self._is_all = False
        self._decode = json.JSONDecoder().raw_decode

    def members(self) -> Iterator[str]:
        """The keys of the object that is next; after each its value must be read. Nothing may follow it."""
        self._expect("{")
        if self._take("}"):
            return
        while True:
            key = self.value()
            if not isinstance(key, str):
                raise JsonError("expected a key in quotation marks")
            self._expect(":")
            yield key
            if not self._goes_on("}"):
                break
        if self._next():
            raise JsonError(f"expected the end, got {self._next()!r}")

    def items(self) -> Iterator[Any]:
        """The items of the array that is next, one after the other."""
        self._expect("[")
        if self._take("]"):
            return
        while True:
            yield self.value()
            if not self._goes_on("]"):
                return

    def value(self) -> Any:
        """The value that is next, whole."""
        if not self._next():
            raise CutOffError("the text ends")
        while True:
            try:
                found, end = self._decode(self._buffer, self._at)
            except json.JSONDecodeError as error:
                if self._is_all:
                    raise self._wrong(error) from None
            except RecursionError:
                raise JsonError("nested too deeply") from None
            else:
                # A number that ends with what was read, or with its point, may go on.
                if self._buffer[end : end + 1] in _AFTER or self._is_all:
                    if _HALF_NUMBER.match(self._buffer, end):
                        raise CutOffError("the text ends within a number")
                    self._at = end
                    return found
            if len(self._buffer) - self._at > LARGEST_VALUE:
                raise JsonError(f"a value of more than {LARGEST_VALUE >> 20} million characters")
            self._more(max(PIECE, len(self._buffer) - self._at))

    def _goes_on(self, closing: str) -> bool:
        """Whether a comma is next, and not the closing mark."""
        if self._take(","):
            return True
        self._expect(closing)
        return False

    def _take(self, mark: str) -> bool:
        if self._next() != mark:
            return False
        self._at += 1
        return True

    def _expect(self, mark: str) -> None:
        found = self._next()
        if not found:
            raise CutOffError("the text ends")
        if not self._take(mark):
            raise JsonError(f"expected {mark!r}, got {found!r}")

    def _next(self) -> str:
        """The next character that is no white space; empty at the end."""
        while True:
            while self._at < len(self._buffer) and self._buffer[self._at] in " \t\r\n":
                self._at += 1
            if self._at < len(self._buffer):
                return self._buffer[self._at]
            if self._is_all:
                return ""
            self._more(PIECE)

    def _more(self, least: int) -> None:
        """Read on, and forget what has been used."""
        parts, size = [self._buffer[self._at :]], 0
        while size < least:
            line = next(self._lines, None)
            if line is None:
                self._is_all = True
                break
            parts.append(line + "\n")
            size += len(line) + 1
        self._buffer, self._at = "".join(parts), 0

    def _wrong(self, error: json.JSONDecodeError) -> JsonError:
        rest = self._buffer[error.pos :].strip()
        ends = not rest or any(literal.startswith(rest) for literal in _LITERALS)
        ends = ends or bool(_HALF_ESCAPE.match(rest))
        kind = CutOffError if ends or error.msg.startswith("Unterminated string") else JsonError
        return kind(f"{error.msg} at {rest[:20]!r}" if rest else error.msg)
