"""A device's program between the device and the operator's program: told the time, it never waits."""

from farhand.common.link.link import Link
from farhand.common.messages.steering import unsent
from farhand.common.timing.clock import to_ns
from farhand.common.timing.periodic import Periodic
from farhand.operator_side.devices.hand import Hand, Obstacles
from farhand.operator_side.devices.hearing import Hearing
from farhand.operator_side.devices.reading import Reading
from farhand.operator_side.steering.hand.sender import SteeringSender

PERIOD = 0.01
REFUSED = (
    "the operator's program does not take this hand: another has the wheel, or it was not heard; press anew"
)


class DeviceNode:
    """Args:
    hand: what is wanted.
    link: to the operator's report endpoint.
    sender: of the same link.

    Attributes:
        reading: the newest, set by the thread that reads the device; None: nothing is plugged in.
        strength: how much of what is asked is not done, 0..1; 0 while nothing is held.
        says: for people: what the hand does, or waits for.
    """

    def __init__(self, hand: Hand, link: Link, sender: SteeringSender) -> None:
        self.reading: Reading | None = None
        self.strength, self.says = 0.0, ""
        self._hand, self._link, self._sender = hand, link, sender
        self._hearing = Hearing()
        self._pressed_ns: int | None = None
        self._ticks = Periodic(to_ns(PERIOD))

    def step(self, now_ns: int) -> int | None:
        """Hear, feel, send; see Node."""
        if self._ticks.due(now_ns):
            for packet in self._link.receive():
                self._hearing.take(packet)
            obstacles = self._hearing.obstacles(now_ns)
            if self._pressed_ns is not None and self._hearing.refuses(self._pressed_ns, now_ns):
                obstacles = Obstacles(lost=REFUSED)
            wish = self._hand.feel(self.reading, now_ns, obstacles)
            if not wish.engaged:
                self._pressed_ns = None
            elif self._pressed_ns is None:
                self._pressed_ns = now_ns
            self._sender.send(wish, now_ns, drives=self._hand.drives)
            self.strength = self._hearing.resistance(now_ns) if wish.engaged else 0.0
            if self.says != REFUSED or not self._hand.waits_for_release:
                self.says = self._hand.says
        return self._ticks.next_ns

    def leave(self, now_ns: int) -> None:
        """Give the wheel up; the last message of a session."""
        self._sender.send(unsent(release=True), now_ns, drives=False)
