"""Sends what a hand wants to the operator's program: console, gamepad and all others do it by this one class."""

import msgspec

from farhand.common.link.link import Link, Packet
from farhand.common.messages.codec import encode
from farhand.common.messages.keys import steering_key
from farhand.common.messages.steering import Steering

IDLE_NS = 500_000_000
"""A driver that holds nothing down is told of so often, so that the wheel stays its own."""


class SteeringSender:
    """Args:
    robot: the robot's name.
    link: to the operator's report endpoint.
    session: this start of the program.
    source: name of the program.
    device: what kind of device it is, for people.
    """

    def __init__(self, robot: str, link: Link, session: int, source: str, device: str) -> None:
        self._key, self._link, self._session = steering_key(robot), link, session
        self._source, self._device = source, device
        self._seq, self._told_ns, self._was_pressed = -1, 0, False

    def send(self, wish: Steering, now_ns: int, *, drives: bool) -> None:
        """Send it, unless nothing is pressed and nothing was; who `drives` is heard of now and then all the same."""
        pressed = wish.engaged or wish.estop or wish.acknowledge or wish.take or wish.release
        idle = drives and now_ns - self._told_ns > IDLE_NS
        if not (pressed or self._was_pressed or idle):
            return
        self._was_pressed, self._told_ns = pressed, now_ns
        self._seq += 1
        steering = msgspec.structs.replace(
            wish,
            source=self._source,
            session=self._session,
            seq=self._seq,
            t_sent_ns=now_ns,
            device=self._device,
        )
        self._link.send(Packet(self._key, encode(steering)))
