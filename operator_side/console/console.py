"""The console between its pages and the operator's program: told the time, it never waits."""

from collections.abc import Callable

from farhand.common.link.link import Link
from farhand.operator_side.console.frames import situation
from farhand.operator_side.console.picture import Picture
from farhand.operator_side.console.robot_model import RobotModel
from farhand.operator_side.console.said import Do, Steer
from farhand.operator_side.console.seat import Seat
from farhand.operator_side.console.status import lost
from farhand.operator_side.steering.sender import SteeringSender

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
        self._link, self._find = link, find_model
        self._sender = SteeringSender(robot, link, session, "console", "the console")
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
        self._tell(now_ns)

    def _tell(self, now_ns: int) -> None:
        wish = self.seat.wish(now_ns)
        self._sender.tell(wish, now_ns, keeps_wheel=self.seat.driver != 0)
