"""What stands in the way that is wanted, and on which side one gets round it: whoever steers is told."""

from collections.abc import Callable
from dataclasses import dataclass

from farhand.common.messages.base import ZERO, Vector3
from farhand.common.messages.state import RobotState
from farhand.operator_side.steering.sides import Free, way_round
from farhand.operator_side.steering.tester.sidestep import Progress

AGAIN_NS = 90_000_000
"""How long the answer to one wish stands: looking round costs many times a tick at 50 Hz, and people read no faster."""


@dataclass(frozen=True, slots=True)
class Blocked:
    """Attributes:
    obstacle: its id; empty: nothing stands in the way.
    side: where the way round is free (`left`, `right`, `above`, `below`); empty: nowhere.
    """

    obstacle: str = ""
    side: str = ""


class Blockage:
    """Looks at every tick; looks for a way round only where there is no progress."""

    def __init__(self) -> None:
        self._progress = Progress()
        self._said, self._for, self._looked_ns = Blocked(), ZERO, -AGAIN_NS

    def look(
        self, wanted: Vector3, state: RobotState, free: Free, obstacle: Callable[[], str], now_ns: int
    ) -> Blocked:
        """What blocks the way now.

        Args:
            wanted: the velocity that is wanted, before the filter (m/s).
            state: newest of the robot.
            free: see sides.Free.
            obstacle: says the id of the one that the filter keeps clear of; empty: of none.
            now_ns: beginning of the tick.
        """
        if not self._progress.lacking(wanted, state.velocity, now_ns):
            return Blocked()
        if wanted != self._for or now_ns - self._looked_ns >= AGAIN_NS:
            self._said, self._for, self._looked_ns = self._find(wanted, free, obstacle), wanted, now_ns
        return self._said

    @staticmethod
    def _find(wanted: Vector3, free: Free, obstacle: Callable[[], str]) -> Blocked:
        name = "" if free([wanted])[0] else obstacle()
        way = way_round(wanted, free) if name else None
        return Blocked(name, way.side if way is not None else "")

    def reset(self) -> None:
        """The robot is not driven."""
        self._progress.reset()
