"""How a program with a hand before it (console, gamepad, bridge) tells the operator's program, on the same host.

A hand that holds something down is told of at every call, its letting go once, and between the two the wheel is kept.
"""

from dataclasses import asdict, dataclass

from farhand.common.link.link import Link, Packet
from farhand.common.messages.base import ZERO, Quaternion, Vector3
from farhand.common.messages.codec import encode
from farhand.common.messages.keys import steering_key
from farhand.common.messages.steering import Frame, Steering, Unit

IDLE_NS = 500_000_000
"""Who has the wheel and holds nothing down says so this often, so that the wheel stays its own."""
_PRESSED = ("engaged", "estop", "acknowledge", "take", "release")


@dataclass(frozen=True, slots=True)
class Wish:
    """What a hand wants now; the fields are those of common/messages/steering.py."""

    engaged: bool = False
    press: int = 0
    linear: Vector3 = ZERO
    angular: Vector3 = ZERO
    unit: Unit = "share"
    frame: Frame = "base"
    view: Quaternion = (1.0, 0.0, 0.0, 0.0)
    scale: float = 1.0
    estop: bool = False
    acknowledge: bool = False
    take: bool = False
    release: bool = False


class SteeringSender:
    """Args:
    robot: the robot's name.
    link: to the operator's report endpoint.
    session: this start of the program; one that was used before is taken for a late message.
    source: name of the program.
    device: what is steered with, for people.
    """

    def __init__(self, robot: str, link: Link, session: int, source: str, device: str) -> None:
        self._key, self._link = steering_key(robot), link
        self._session, self._source, self._device = session, source, device
        self._seq, self._told_ns, self._was_pressed = -1, 0, False

    def tell(self, wish: Wish, now_ns: int, *, keeps_wheel: bool) -> None:
        """Send what is wanted at `now_ns`, if there is anything to say.

        Args:
            wish: of now; one that is older must not be told of.
            now_ns: on the clock of this program.
            keeps_wheel: whether the wheel is to stay this program's while nothing is held down.
        """
        pressed = any(getattr(wish, name) for name in _PRESSED)
        idle = keeps_wheel and now_ns - self._told_ns > IDLE_NS
        if not (pressed or self._was_pressed or idle):
            return
        self._was_pressed, self._told_ns = pressed, now_ns
        self._seq += 1
        steering = Steering(
            source=self._source,
            session=self._session,
            seq=self._seq,
            t_sent_ns=now_ns,
            device=self._device,
            **asdict(wish),
        )
        self._link.send(Packet(self._key, encode(steering)))
