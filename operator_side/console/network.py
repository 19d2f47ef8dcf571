"""The emulated network, where one can be changed: what pages are told of it, and who changes it."""

from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True)
class NetworkTold:
    """What the emulator itself says that it does.

    Attributes:
        names: of the networks that may be chosen.
        uplink, downlink: SPECs.
        outage: whether an outage runs.
        refused: why the last change was not done; empty: it was.
    """

    names: tuple[str, ...]
    uplink: str
    downlink: str
    outage: bool = False
    refused: str = ""

    @property
    def name(self) -> str:
        """One for both directions, where there is one."""
        return self.uplink if self.uplink == self.downlink else f"{self.uplink} / {self.downlink}"


class Network(Protocol):
    """Changes the network; no call waits for it."""

    def told(self) -> NetworkTold | None:
        """The newest; None: no emulator answers."""
        ...

    def choose(self, name: str) -> None:
        """Have the network of that name."""
        ...

    def cut(self, seconds: float) -> None:
        """Have no network for so long."""
        ...
