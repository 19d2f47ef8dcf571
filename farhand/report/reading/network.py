"""What became of the messages at the emulator, by direction."""

from array import array
from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from farhand.common.geometry import Array
from farhand.common.recording.fates import DELIVERED, ON_THE_WAY, Fate


@dataclass
class Direction:
    """Attributes:
    messages: that came to the emulator, copies included.
    lost: by cause.
    corrupted: delivered with a flipped bit.
    """

    messages: int = 0
    lost: Counter[str] = field(default_factory=Counter)
    corrupted: int = 0
    _delays: "array[float]" = field(default_factory=lambda: array("d"))

    def add(self, fate: Fate) -> None:
        """Count a message."""
        self.messages += 1
        if fate.fate == DELIVERED:
            self._delays.append(fate.achieved_ns * 1e-9)
            self.corrupted += fate.corrupted >= 0
        elif fate.fate != ON_THE_WAY:
            self.lost[fate.fate] += 1

    @property
    def delays(self) -> Array:
        """(n,) of those that were delivered (s)."""
        return np.frombuffer(self._delays, dtype=float)


@dataclass
class Network:
    """Attributes:
    ways: by direction.
    entries: that were read.
    unread: that cannot be.
    """

    ways: dict[str, Direction] = field(default_factory=dict)
    entries: int = 0
    unread: int = 0

    def add(self, fate: Fate) -> None:
        """Count a message."""
        self.entries += 1
        self.ways.setdefault(fate.direction, Direction()).add(fate)
