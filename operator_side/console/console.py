"""The console between its pages and the operator's program: told the time, it never waits."""

from collections.abc import Callable
from dataclasses import asdict

from farhand.common.link.link import Link, Packet
from farhand.common.messages.codec import encode
from farhand.common.messages.keys import steering_key
from farhand.common.messages.steering import Steering
from farhand.operator_side.console.camera import CameraFeed
from farhand.operator_side.console.frames import situation
from farhand.operator_side.console.picture import Picture
from farhand.operator_side.console.robot_model import RobotModel
from farhand.operator_side.console.said import Do, Steer
from farhand.operator_side.console.seat import Seat, Wish
from farhand.operator_side.console.status import lost

IDLE_NS = 500_000_000
"""A driver that holds nothing down is told of so often, so that the wheel stays its own."""
_PRESSED = ("engaged", "estop", "acknowledge", "take", "release")

FindModel = Callable[[str], RobotModel | None]
"""The drawing of a model by its name; None where there is none."""


class Console:
    """Args:
    robot: the robot's name.
    link: to the operator's report endpoint.
    session: this start of the program.
    find_model: see there.
    """

    def __init__(self, robot: str, link: Link, session: int, find_model: FindModel = lambda _: None) -> None:
        self.robot, self.seat, self.picture = robot, Seat(), Picture(robot)
        self.camera = CameraFeed(robot)
        self._link, self._session, self._find = link, session, find_model
        self._seq, self._told_ns, self._was_pressed = -1, 0, False
        self._model: tuple[str, RobotModel | None] = ("", None)

    @property
    def model(self) -> RobotModel | None:
        """The drawing of the robot; None while it is not known, or has none."""
        robot = self.picture.description
        if robot is not None and robot.model != self._model[0]:
            self._model = (robot.model, self._find(robot.model) if robot.model else None)
        return self._model[1]

    def beat(self, now_ns: int) -> None:
        """Take what has come, lock what must not be driven, tell the operator's program; 50 times a second."""
        for packet in self._link.receive():
            self.picture.take(packet)
            self.camera.take(packet)
        self.camera.look(self.picture, now_ns)
        if self.picture.state is not None and self.picture.state.mode == "estop":
            self.seat.stopped()
        self.seat.lock(lost(situation(self.picture, self.seat, now_ns)))
        self._tell(now_ns)

    def hear(self, number: int, said: Steer | Do, now_ns: int) -> bool:
        """Take what a page says, and pass it on at once; False where it must go."""
        stays = self.seat.hear(number, said, now_ns)
        self._tell(now_ns)
        return stays

    def leave(self, number: int, now_ns: int) -> None:
        """A page is gone."""
        self.seat.leave(number)
        self.camera.leave(number)
        self._tell(now_ns)

    def _tell(self, now_ns: int) -> None:
        wish = self.seat.wish(now_ns)
        pressed = any(getattr(wish, name) for name in _PRESSED)
        idle = self.seat.driver != 0 and now_ns - self._told_ns > IDLE_NS
        if not (pressed or self._was_pressed or idle):
            return
        self._was_pressed, self._told_ns = pressed, now_ns
        self._seq += 1
        self._link.send(Packet(steering_key(self.robot), encode(self._message(wish, now_ns))))

    def _message(self, wish: Wish, now_ns: int) -> Steering:
        return Steering(
            source="console",
            session=self._session,
            seq=self._seq,
            t_sent_ns=now_ns,
            device="the console",
            **asdict(wish),
        )
