"""Sends what was asked in a recorded run to an operator's program that is steered from others: told the time."""

from farhand.common.link.link import Link
from farhand.common.messages.steering import unsent
from farhand.common.timing.clock import to_ns
from farhand.common.timing.periodic import Periodic
from farhand.operator_side.devices.device_node import PERIOD
from farhand.operator_side.devices.hearing import Hearing
from farhand.operator_side.steering.hand.sender import SteeringSender
from farhand.operator_side.steering.recorded.playback import Playback
from farhand.operator_side.supervision import NOT_ENGAGED


class PlaybackNode:
    """Begins once the operator's program waits for a hand; what ends a press goes on with the next one of then.

    Args:
        playback: what is played.
        link: to the operator's report endpoint.
        sender: of the same link.

    Attributes:
        says: for people: what it does, or waits for.
        over: whether all was asked.
    """

    def __init__(self, playback: Playback, link: Link, sender: SteeringSender) -> None:
        self.says, self.over = "", False
        self._playback, self._link, self._sender = playback, link, sender
        self._hearing = Hearing()
        self._ticks = Periodic(to_ns(PERIOD))

    def step(self, now_ns: int) -> int | None:
        """Hear, and send what is asked now; see Node."""
        if self._ticks.due(now_ns) and not self.over:
            for packet in self._link.receive():
                self._hearing.take(packet)
            self._play(now_ns)
        return self._ticks.next_ns

    def leave(self, now_ns: int) -> None:
        """Give the wheel up; the last message of a session."""
        self._sender.send(unsent(release=True), now_ns, drives=False)

    def _play(self, now_ns: int) -> None:
        found, report, playback = self._hearing.obstacles(now_ns), self._hearing.report, self._playback
        why = found.lost or found.stopped
        if playback.started_ns is None:
            if why or report is None or report.stop_reason != NOT_ENGAGED:
                self.says = (
                    f"waits: {why or (report.stop_reason if report else '') or 'somebody else drives'}"
                )
                return
            playback.start(now_ns)
        asked = playback.asked(now_ns, let_go=bool(why))
        self.over = playback.left_ns(now_ns) <= 0
        seconds = playback.course.duration_ns * 1e-9
        self.says = f"let go, until the next press: {why}" if why else f"plays {seconds:.1f} s"
        if self.over:
            self.says = f"all {seconds:.1f} s are played"
        wish = unsent(
            engaged=asked.press > 0,
            press=asked.press,
            linear=asked.linear,
            angular=asked.angular,
            unit="si",
            estop=asked.estop,
        )
        self._sender.send(unsent(release=True) if self.over else wish, now_ns, drives=True)
