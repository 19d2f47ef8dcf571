"""Whether the robot moves as it is told, by its own measure: what was sent against the speed in its state."""

from collections import deque
from dataclasses import dataclass

from farhand.common.geometry import norm
from farhand.common.messages.base import Vector3
from farhand.common.messages.report import ControlReport
from farhand.common.messages.state import RobotState

FOLLOWS = 0.8
"""Share of what was sent, along it, from which on the robot does it."""
STANDS = 0.1
"""Share under which it does nothing of it that is worth the word."""
STARTS_S = 0.3
"""How long a robot may take to get going (s), beyond the round trip and the age of its state."""
LEAST_SPEED, LEAST_TURN = 1e-3, 1e-2
"""What asks for less is no wish (m/s, rad/s)."""


@dataclass(frozen=True, slots=True)
class Shortfall:
    """What the robot does of what was sent.

    Attributes:
    done, sent: the measured speed along the sent one, and that one.
    unit: `m/s`, or `rad/s` where it is the turning.
    lasting: whether nothing that was sent within round trip and start-up explains it.
    """

    done: float
    sent: float
    unit: str
    lasting: bool

    @property
    def stands(self) -> bool:
        """Whether it does nothing of it."""
        return self.done < STANDS * self.sent

    @property
    def unfollowed(self) -> bool:
        """Whether it does nothing of it, and nothing that is under way explains that."""
        return self.lasting and self.stands


class Following:
    """Told again and again of the newest report and state.

    A robot that does anything of what was sent within round trip and start-up is at most on the way to what was sent
    just now; one that does nothing of all that does not follow.
    """

    def __init__(self) -> None:
        self._sent: deque[tuple[int, Vector3, Vector3]] = deque()

    def note(
        self, report: ControlReport | None, state: RobotState | None, state_age: float, now_ns: int
    ) -> Shortfall | None:
        """What is missing at `now_ns`; None: nothing, or nothing was sent.

        Args:
            report, state: newest.
            state_age: of the state (s).
            now_ns: the clock.
        """
        if report is None or state is None or report.mode != "run":
            self._sent.clear()
            return None
        if not self._sent or self._sent[-1][1:] != (report.filtered, report.angular):
            self._sent.append((now_ns, report.filtered, report.angular))
        oldest_ns = now_ns - round((STARTS_S + (report.rtt_mean or 0.0) + state_age) * 1e9)
        while len(self._sent) > 1 and self._sent[1][0] <= oldest_ns:
            self._sent.popleft()
        return self._missing(
            [linear for _, linear, _ in self._sent], state.velocity, LEAST_SPEED, "m/s", oldest_ns
        ) or self._missing(
            [angular for _, _, angular in self._sent], state.angular_velocity, LEAST_TURN, "rad/s", oldest_ns
        )

    def _missing(
        self, sent: list[Vector3], measured: Vector3, least: float, unit: str, oldest_ns: int
    ) -> Shortfall | None:
        newest = norm(sent[-1])
        if newest <= least or _does(measured, sent[-1]):
            return None
        # It stands for good only where it did none of all that was sent for the whole of that time.
        known = self._sent[0][0] <= oldest_ns
        lasting = known and not any(norm(each) <= least or _does(measured, each) for each in sent)
        return Shortfall(_along(measured, sent[-1]), newest, unit, lasting)


def _along(measured: Vector3, sent: Vector3) -> float:
    """The speed along what was sent."""
    return sum(m * s for m, s in zip(measured, sent, strict=True)) / norm(sent)


def _does(measured: Vector3, sent: Vector3) -> bool:
    return _along(measured, sent) >= FOLLOWS * norm(sent)
