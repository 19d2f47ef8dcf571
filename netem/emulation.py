"""What is to be emulated: the network of each direction, robots' own networks, the draws, the memory."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from farhand.netem.release_queue import Limits
from farhand.netem.spec import Spec


@dataclass(frozen=True)
class Emulation:
    """What a NetemNode emulates.

    Attributes:
        uplink, downlink: what the network is like from the operator to the robot, and back.
        seed: of all draws.
        own: by robot, what a direction ("uplink", "downlink") is like for it instead; a robot draws from streams
            of its own in a network of its own.
        limits: bounds of each direction's memory.
    """

    uplink: Spec
    downlink: Spec
    seed: int
    own: Mapping[str, Mapping[str, Spec]] = field(default_factory=dict)
    limits: Limits = field(default_factory=Limits)

    def spec(self, direction: str) -> Spec:
        """The common network of "uplink" or "downlink"."""
        return self.uplink if direction == "uplink" else self.downlink

    def own_specs(self, direction: str) -> dict[str, Spec]:
        """The networks of one direction that robots have for their own, by robot."""
        return {robot: ways[direction] for robot, ways in self.own.items() if direction in ways}
