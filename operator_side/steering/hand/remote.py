"""A hand at another program of this host: the console in a browser, a gamepad, a bridge. Hold-to-run is enforced here.

Whatever that program does, the robot is moved only while its newest message is in order, was not held up under way,
came less than 0.15 s ago, is of the one who has the wheel, and of a press that nothing has ended since.
"""

from typing import Any, ClassVar

import msgspec

from farhand.common.geometry import norm
from farhand.common.link.link import Link
from farhand.common.messages.base import ZERO, Positive, Quaternion, Vector3
from farhand.common.messages.codec import Decoder
from farhand.common.messages.state import RobotState
from farhand.common.messages.steering import Steering
from farhand.common.scenario.section import Section
from farhand.operator_side.steering.device import SteeringDevice, SteeringInput, View
from farhand.operator_side.steering.first_seen import ESTOP_AT_LEAST_NS, FirstSeen
from farhand.operator_side.steering.hand.latch import Latch
from farhand.operator_side.steering.hand.wheel import Wheel

LATE_NS = 150_000_000
"""A message that took so much longer than the fastest of its program presses nothing; it still stops and lets go."""
_LATCHED = ("stopped", "estop")


class RemoteSettings(Section, frozen=True, kw_only=True):
    """Attributes:
    speed: what a share of 1 of the linear axes is (m/s).
    turn_speed: what a share of 1 of the angular axes is (rad/s).
    """

    speed: Positive = 0.25
    turn_speed: Positive = 0.6


class Remote(SteeringDevice):
    """See the module's docstring. Without a link nothing steers, and it holds.

    An emergency stop is taken from everybody who can be heard, and asked for until the robot has latched it; an
    acknowledgement counts for the one stop that was there when it came. Neither leaves a hand armed.
    """

    Settings: ClassVar[type[Section]] = RemoteSettings
    ends_with_targets: ClassVar[bool] = False
    rate_hz: ClassVar[float | None] = 50.0

    def __init__(self, settings: Any = None) -> None:
        super().__init__(settings or RemoteSettings())
        self.link: Link | None = None
        self.wheel, self.latch = Wheel(), Latch()
        self._seen = FirstSeen()
        self._estop_by = 0  # session of who asked for it last
        self._decoder = Decoder(Steering)
        self._newest: Steering | None = None  # of who has the wheel
        self._seqs: dict[int, int] = {}  # newest of each session, the last few
        self._fastest: dict[
            int, int
        ] = {}  # of each session, the least time under way, but for a constant (ns)
        self._estop_ns: int | None = None  # when one that the robot has not latched yet was asked for
        self._clears: tuple[str, int, str] | None = None  # the stop that is being acknowledged

    def listen(self, link: Link) -> None:
        """Take steering from there on from a link, of which no other class of message comes."""
        self.link = link

    def read(self, view: View) -> SteeringInput:
        """What the hand wants at the view's instant."""
        for packet in self.link.receive() if self.link is not None else ():
            steering = self._decoder.decode(packet.payload)
            if steering is not None and self._in_order(steering):
                self._hear(self._in_time(steering, packet.arrived_ns), packet.arrived_ns, view.state)
        state = view.state
        if state.mode in _LATCHED:
            self.latch.disarm()
        asked_ns, seen_ns = self._estop_ns, self._seen.look(state, view.now_ns)
        if asked_ns is not None and state.mode == "estop" and seen_ns - asked_ns >= ESTOP_AT_LEAST_NS:
            self._estop_ns = None
        if view.stopping or self._clears != _stop_of(state):
            self._clears = None
        if not self.wheel.look(view.now_ns):
            self._newest = None
        holds = self.latch.holds(view.now_ns) and self._newest is not None
        linear, angular = self._wanted(state) if holds else (ZERO, ZERO)
        return SteeringInput(
            velocity=linear,
            angular=angular,
            engaged=holds,
            acknowledge=self._clears is not None,
            estop=self._estop_ns is not None,
            says="" if holds else self._why_not(view.now_ns),
        )

    def _in_order(self, steering: Steering) -> bool:
        if steering.seq <= self._seqs.pop(steering.session, -1):
            return False
        self._seqs[steering.session] = steering.seq
        while len(self._seqs) > 16:
            oldest = next(iter(self._seqs))
            del self._seqs[oldest]
            self._fastest.pop(oldest, None)
        return True

    def _in_time(self, steering: Steering, arrived_ns: int) -> Steering:
        """The message; without its press, where it was held up, as while this program was frozen: that is old."""
        took_ns = arrived_ns - steering.t_sent_ns
        fastest_ns = min(took_ns, self._fastest.get(steering.session, took_ns))
        self._fastest[steering.session] = fastest_ns
        if took_ns - fastest_ns <= LATE_NS:
            return steering
        return msgspec.structs.replace(steering, engaged=False, acknowledge=False, take=False)

    def _hear(self, steering: Steering, now_ns: int, state: RobotState) -> None:
        if steering.estop:
            self._estop_ns, self._estop_by = now_ns, steering.session
            self._clears = None
            self.latch.disarm()
        had = self.wheel.driver
        wants = (steering.engaged or steering.take or steering.acknowledge) and not steering.release
        if not self.wheel.ask(steering.session, steering.device, now_ns, wants=wants):
            return
        if self.wheel.driver != had:
            self.latch = Latch()
        # another hand's emergency stop that is still sent was not there to be acknowledged
        own = steering.session == self._estop_by and not steering.estop and state.mode == "estop"
        if steering.acknowledge and (own or self._estop_ns is None) and _stop_of(state) is not None:
            self._clears, self._estop_ns = _stop_of(state), None
        self.latch.hear(steering.engaged and not steering.estop, steering.press, now_ns)
        self._newest = steering
        if steering.release:
            self.latch.disarm()
            self.wheel.free()

    def _wanted(self, state: RobotState) -> tuple[Vector3, Vector3]:
        """Linear and angular velocity in base (m/s, rad/s)."""
        steering = self._newest
        assert steering is not None
        linear, angular = steering.linear, steering.angular
        if steering.unit == "share":
            linear = _scaled(_at_most_one(linear), self.settings.speed)
            angular = _scaled(_at_most_one(angular), self.settings.turn_speed)
        axes: Quaternion = (1.0, 0.0, 0.0, 0.0)
        if steering.frame == "tool":
            axes = state.orientation
        elif steering.frame == "view":
            axes = steering.view
        return rotated(axes, _scaled(linear, steering.scale)), rotated(axes, _scaled(angular, steering.scale))

    def _why_not(self, now_ns: int) -> str:
        if not self.wheel.driver:
            return "nobody steers"
        if self.latch.silent(now_ns):
            return f"{self.wheel.name} is silent"
        return f"nothing is held down at {self.wheel.name}"


def rotated(orientation: Quaternion, vector: Vector3) -> Vector3:
    """A vector given in a frame of that orientation, in the frame that the orientation is given in.

    Args:
        orientation: quaternion (w, x, y, z), of any length but zero: none turns nothing.
        vector: of any unit.
    """
    length = norm(orientation)
    if length < 1e-9:
        return vector
    w, x, y, z = (q / length for q in orientation)
    a, b, c = vector
    # v + 2 u × (u × v + w v)
    p = (y * c - z * b + w * a, z * a - x * c + w * b, x * b - y * a + w * c)
    return (
        a + 2.0 * (y * p[2] - z * p[1]),
        b + 2.0 * (z * p[0] - x * p[2]),
        c + 2.0 * (x * p[1] - y * p[0]),
    )


def _stop_of(state: RobotState) -> tuple[str, int, str] | None:
    """What an acknowledgement clears: this stop, or the want of a holder; None where there is nothing.

    A stop that gives another reason is another one: a robot that could not be driven then can now, or the reverse.
    The holder is no part of a stop: who lost control in silence asks for it by the same acknowledgement.
    """
    if state.mode in _LATCHED:
        return (state.mode, state.stops, state.reason)
    return ("free", 0, "") if state.holder == 0 else None


def _at_most_one(vector: Vector3) -> Vector3:
    """The vector, shortened to length 1 if it is longer: two keys at once are not faster than one."""
    length = norm(vector)
    return vector if length <= 1.0 else _scaled(vector, 1.0 / length)


def _scaled(vector: Vector3, factor: float) -> Vector3:
    x, y, z = vector
    return (x * factor, y * factor, z * factor)
