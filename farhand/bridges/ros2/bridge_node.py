"""The bridge in its loop: told the time, it never waits. What comes from ROS drives; what Farhand says is handed on."""

from collections.abc import Callable, Sequence
from typing import Protocol

from farhand.bridges.ros2.inbound.twist_hand import SILENCE_NS
from farhand.common.link.link import Link, Packet
from farhand.common.messages.keys import kind_of
from farhand.common.messages.steering import Steering, unsent
from farhand.operator_side.devices.device_node import REFUSED
from farhand.operator_side.devices.hand import Obstacles
from farhand.operator_side.devices.hearing import Hearing
from farhand.operator_side.steering.hand.sender import SteeringSender

LOOK_NS = 20_000_000
"""The loop is awake so often at least."""
HELD_NS, HELD_EARLY_NS = 12_000_000, 3_000_000
IDLE_NS, IDLE_EARLY_NS = 30_000_000, 12_000_000
"""What drives is said again so soon, what does not is looked at, or so much earlier where the loop is awake anyway: a
stream of twists that is due every 10 or 20 ms wakes it often enough for both."""
NEVER_NS = 1 << 62


class Device(Protocol):
    """What steers."""

    @property
    def drives(self) -> bool:
        """Whether it keeps the wheel."""
        ...

    @property
    def says(self) -> str:
        """For people."""
        ...

    def hear(self, now_ns: int) -> bool:
        """Take what has come; whether anything has."""
        ...

    def wish(self, now_ns: int, obstacles: Obstacles) -> Steering:
        """What is wanted."""
        ...


class _Seat:
    """A device and its way to the operator."""

    def __init__(self, device: Device, sender: SteeringSender) -> None:
        self.device, self.sender = device, sender
        self.pressed_ns: int | None = None
        self.due_ns, self.silent_ns = 0, NEVER_NS
        self.engaged, self.says = False, ""


class BridgeNode:
    """Args:
    link: to the operator's report endpoint, or the robot's side.
    seats: what steers, each with the sender of its own; none on the robot's side.
    hand_on: called with each packet that came and the instant.

    Attributes:
        paused: while set, nothing that comes from ROS moves anything; set from any thread.
        says: for people: what steers, or what it waits for.
        hearing: of the operator's reports.
    """

    def __init__(self, link: Link, seats: Sequence[tuple[Device, SteeringSender]],
                 hand_on: Callable[[Packet, int], None]) -> None:  # fmt: skip
        self.paused, self.says = False, ""
        self.hearing = Hearing()
        self._link, self._hand_on = link, hand_on
        self._seats = [_Seat(device, sender) for device, sender in seats]

    def step(self, now_ns: int) -> int | None:
        """Hear, hand on, send; see Node."""
        for packet in self._link.receive():
            if kind_of(packet.key) == "report":
                self.hearing.take(packet)
            self._hand_on(packet, now_ns)
        return min([now_ns + LOOK_NS, *(self._look(seat, now_ns) for seat in self._seats)])

    def leave(self, now_ns: int) -> None:
        """Give the wheel up; the last message of a session."""
        for seat in self._seats:
            seat.sender.send(unsent(release=True), now_ns, drives=False)

    def _look(self, seat: _Seat, now_ns: int) -> int:
        """Take what has come for a seat, and send what it wants; returns when to look again."""
        if seat.device.hear(now_ns):
            seat.silent_ns = now_ns + SILENCE_NS + 1
            seat.due_ns = now_ns
        early_ns = HELD_EARLY_NS if seat.engaged else IDLE_EARLY_NS
        if now_ns + early_ns >= seat.due_ns or now_ns >= seat.silent_ns:
            self._send(seat, now_ns)
            seat.due_ns = now_ns + (HELD_NS if seat.engaged else IDLE_NS)
            seat.silent_ns = seat.silent_ns if now_ns < seat.silent_ns else NEVER_NS
        return min(seat.due_ns, seat.silent_ns)

    def _send(self, seat: _Seat, now_ns: int) -> None:
        obstacles = self.hearing.obstacles(now_ns)
        if self.paused:
            obstacles = Obstacles(lost="paused: ~/pause_servo with false goes on")
        elif seat.pressed_ns is not None and self.hearing.refuses(seat.pressed_ns, now_ns):
            obstacles = Obstacles(lost=REFUSED)
        wish = seat.device.wish(now_ns, obstacles)
        if not wish.engaged:
            seat.pressed_ns = None
        elif seat.pressed_ns is None:
            seat.pressed_ns = now_ns
        seat.sender.send(wish, now_ns, drives=seat.device.drives)
        seat.engaged, seat.says = wish.engaged, obstacles.lost or obstacles.stopped or seat.device.says
        driving = [each.says for each in self._seats if each.engaged]
        self.says = "; ".join(driving or dict.fromkeys(each.says for each in self._seats if each.says))
