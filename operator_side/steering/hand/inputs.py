"""What moves an axis: the names of a device's sticks, triggers and buttons, with signs, and how they are shaped.

`-lefty` is the left stick, forwards; `righttrigger -lefttrigger` is one trigger against the other.
"""

from collections.abc import Callable
from dataclasses import dataclass

Value = Callable[[str], float]
"""The value of an input by its name: sticks -1..1, triggers 0..1, buttons 0 or 1."""


@dataclass(frozen=True, slots=True)
class Inputs:
    """A sum of inputs.

    Attributes:
        terms: sign and name of each.
    """

    terms: tuple[tuple[float, str], ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Of all of them."""
        return tuple(name for _, name in self.terms)

    def value(self, value: Value) -> float:
        """The sum, at most 1 in size."""
        total = sum(sign * value(name) for sign, name in self.terms)
        return max(-1.0, min(1.0, total))


def read_inputs(text: str) -> Inputs:
    """Inputs from text; the empty text is none. Raises ValueError in words."""
    terms = []
    for word in text.split():
        sign, name = (-1.0, word[1:]) if word[0] == "-" else (1.0, word.removeprefix("+"))
        if not name.isalnum():
            raise ValueError(
                f"{word!r} is no input; expected names with signs such as '-lefty' or 'dpup -dpdown'"
            )
        terms.append((sign, name))
    return Inputs(tuple(terms))


def shaped(value: float, dead_zone: float, expo: float) -> float:
    """A stick's value after its dead zone and its curve: still 0 at the edge of the zone, still 1 at the end.

    Args:
        value: -1..1.
        dead_zone: what is smaller is 0; 0 up to below 1.
        expo: 0 is straight, 1 is cubic: fine near the centre.
    """
    size = min(1.0, abs(value))
    if size <= dead_zone:
        return 0.0
    size = (size - dead_zone) / (1.0 - dead_zone)
    size = (1.0 - expo) * size + expo * size**3
    return size if value > 0.0 else -size
