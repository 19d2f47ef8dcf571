"""A Zenoh client that sees what a robot says, and what its operator reports, and waits for what shall happen."""

import threading
from collections import deque
from collections.abc import Callable
from typing import TypeVar

import zenoh

from farhand.common.link.zenoh_link import open_session
from farhand.common.messages.base import Message
from farhand.common.messages.codec import Decoder
from farhand.common.messages.keys import report_key, scene_key, state_key
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.testing.programs import PATIENCE

M = TypeVar("M", bound=Message)
KEPT = 100_000
"""So many of the newest states and reports are kept: more than half an hour of states."""


class Witness:
    """Sees one robot from outside, with real Zenoh.

    Args:
        endpoint: where the robot, or the emulator's operator side, is.
        robot: its name.
        reports: where its operator reports; empty: nowhere.

    Attributes:
        session: the Zenoh session, for what a test wants to send.
        scene: the newest.
        refused: what arrived and was no message of its kind; whoever waits then fails.
    """

    def __init__(self, endpoint: str, robot: str = "r", reports: str = "") -> None:
        self._states: deque[RobotState] = deque(maxlen=KEPT)
        self._reports: deque[ControlReport] = deque(maxlen=KEPT)
        self.scene: Scene | None = None
        self._changed = threading.Condition()
        self._arrived = 0
        self.refused: list[str] = []
        self.session = open_session([endpoint])
        self._sessions = [self.session]
        self._listen(self.session, state_key(robot), Decoder(RobotState), self._take_state)
        self._listen(self.session, scene_key(robot), Decoder(Scene), self._take_scene)
        if reports:
            self._sessions.append(open_session([reports]))
            self._listen(self._sessions[-1], report_key(robot), Decoder(ControlReport), self._reports.append)

    @property
    def states(self) -> list[RobotState]:
        """All states that have arrived, oldest first."""
        with self._changed:
            return list(self._states)

    @property
    def reports(self) -> list[ControlReport]:
        """All reports that have arrived, oldest first."""
        with self._changed:
            return list(self._reports)

    def forget(self) -> None:
        """Begin anew: no states, no reports."""
        with self._changed:
            self._states.clear()
            self._reports.clear()

    def wait_until(self, holds: Callable[[RobotState], object], patience: float = PATIENCE) -> RobotState:
        """The first state from now on for which it holds; AssertionError if none comes within `patience` (s)."""
        found: list[RobotState] = []
        with self._changed:
            looked = self._arrived

            def look() -> bool:
                nonlocal looked
                states = list(self._states)
                fresh = min(self._arrived - looked, len(states))
                looked = self._arrived
                found.extend(s for s in states[len(states) - fresh :] if holds(s))
                return bool(found)

            self._wait(look, patience)
        return found[0]

    def wait_for(self, holds: Callable[[], object], patience: float = PATIENCE) -> None:
        """Until it holds of what has arrived, looked at after each arrival; else AssertionError."""
        with self._changed:
            self._wait(lambda: bool(holds()), patience)

    def close(self) -> None:
        """Leave."""
        for session in self._sessions:
            session.close()  # type: ignore[no-untyped-call]

    def _wait(self, holds: Callable[[], bool], patience: float) -> None:
        came = self._changed.wait_for(lambda: bool(self.refused) or holds(), patience)
        seen = self.states[-1:], self.reports[-1:]
        assert not self.refused, f"refused: {self.refused}"
        assert came, f"it did not come within {patience:g} s; last {seen}"

    def _listen(
        self, session: zenoh.Session, key: str, decoder: Decoder[M], take: Callable[[M], object]
    ) -> None:
        def arrived(sample: zenoh.Sample) -> None:
            message = decoder.decode(sample.payload.to_bytes())
            with self._changed:
                if message is None:
                    self.refused.append(f"{key}: {decoder.last_refusal}")
                else:
                    take(message)
                self._changed.notify_all()

        session.declare_subscriber(key, arrived)

    def _take_state(self, state: RobotState) -> None:
        self._states.append(state)
        self._arrived += 1

    def _take_scene(self, scene: Scene) -> None:
        self.scene = scene
