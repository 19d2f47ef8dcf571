"""What every target is: seeds, and what takes an input. A finding is whatever the input makes it raise."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

Shape = Literal["bytes", "text", "map", "json"]
"""Of what a valid input is, so that some mutations keep it one: MessagePack maps, JSON objects, or neither."""


@dataclass(frozen=True, slots=True)
class Target:
    """Attributes:
    edge: what it is, in a few words.
    promise: what is asserted of every input, beside that nothing is raised and memory is bounded.
    seeds: valid inputs.
    start: makes what takes an input, once a process; each input begins anew, so that a finding can be repeated.
    shape: of a valid input.
    head: bytes before it that say what is done with it, such as which message it is.
    longest: bytes of an input.
    """

    edge: str
    promise: str
    seeds: Callable[[], list[bytes]]
    start: Callable[[], Callable[[bytes], None]]
    shape: Shape = "bytes"
    head: int = 0
    longest: int = 4096


class FindingError(AssertionError):
    """An input broke a promise."""


def check(holds: bool, what: str) -> None:
    """Raise FindingError unless it holds."""
    if not holds:
        raise FindingError(what)


def finite(value: Any) -> bool:
    """Whether all numbers in nested lists and maps are."""
    if isinstance(value, float):
        return math.isfinite(value)
    if isinstance(value, dict):
        return all(map(finite, value.values()))
    return not isinstance(value, list | tuple) or all(map(finite, value))


def one_line(error: BaseException) -> None:
    """A refusal is one line that a person can read."""
    said = str(error)
    check(bool(said.strip()) and "\n" not in said, f"a refusal is no line: {said[:200]!r}")
    check(len(said) < 100_000, f"a refusal of {len(said)} letters")
