"""What a device shows at one instant, whatever kind it is."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True)
class Reading:
    """Attributes:
    device: its name, for people.
    plugged: counts the pluggings in; another number is another device, or the same one anew.
    inputs: by name: sticks -1..1, triggers 0..1, buttons 0 or 1.
    read_ns: when it was read.
    mapped: whether the names of its inputs are those of its kind, not raw numbers alone.
    """

    device: str
    plugged: int
    inputs: Mapping[str, float]
    read_ns: int
    mapped: bool = True


class Source(Protocol):
    """A device, or the place for one. Its methods may take their time: no sending loop calls them.

    Attributes:
        trouble: why one that is plugged in cannot be used, for people; empty: nothing is known of any.
    """

    trouble: str

    def read(self, now_ns: int) -> Reading | None:
        """What it shows now; None while nothing is plugged in. Never raises."""
        ...

    def found(self) -> list[dict[str, object]]:
        """All that are plugged in: `name`, `kind`, `mapping`, and the numbers of `axes`, `buttons` and `hats`."""
        ...

    def rumble(self, strength: float) -> None:
        """Shake for a fifth of a second, 0..1, if it can."""
        ...

    def close(self) -> None:
        """Give it back."""
        ...
