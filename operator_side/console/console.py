"""The console between its pages and the operator's program: told the time, it never waits."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from farhand.common.link.link import Link
from farhand.common.messages.keys import mirror_key
from farhand.common.timing.clock import to_ns
from farhand.operator_side.console.absence import Absence
from farhand.operator_side.console.camera import CameraFeed
from farhand.operator_side.console.following import Following, Shortfall
from farhand.operator_side.console.frames import frame, situation
from farhand.operator_side.console.network import Network, NetworkTold
from farhand.operator_side.console.picture import Picture
from farhand.operator_side.console.robot_model import RobotModel
from farhand.operator_side.console.said import ChooseNetwork, Ordered
from farhand.operator_side.console.seat import Seat
from farhand.operator_side.console.sight import Sight
from farhand.operator_side.console.status import LOST_AFTER, Situation, lost, unheard
from farhand.operator_side.steering.hand.sender import SteeringSender

FindModel = Callable[[str], RobotModel | None]
"""The drawing of a model by its name; None where there is none."""


class Console:
    """Args:
    robot: the robot's name.
    link: to the operator's report endpoint.
    session: this start of the program.
    find_model: see there.
    network: None: it cannot be changed from here.
    """

    def __init__(
        self,
        robot: str,
        link: Link,
        session: int,
        find_model: FindModel = lambda _: None,
        network: Network | None = None,
    ) -> None:
        self.robot, self.seat, self.picture = robot, Seat(), Picture(robot)
        self.camera = CameraFeed(robot)
        self._link, self._find, self._network = link, find_model, network
        self._sender = SteeringSender(robot, link, session, "console", "the console")
        self._absence, self._sight = Absence(to_ns(LOST_AFTER)), Sight()
        self._following = Following()
        self._short: Shortfall | None = None
        self._idle_ns = 0
        self._camera_key = mirror_key(robot, "camera")
        self._model: tuple[str, RobotModel | None] = ("", None)

    @property
    def model(self) -> RobotModel | None:
        """The drawing of the robot; None while it is not known, or has none."""
        robot = self.picture.description
        if robot is not None and robot.model != self._model[0]:
            self._model = (robot.model, self._find(robot.model) if robot.model else None)
        return self._model[1]

    @property
    def network(self) -> NetworkTold | None:
        """The network as it is, where it can be changed."""
        return self._network.told() if self._network is not None else None

    def beat(self, now_ns: int) -> None:
        """Take what has come, lock what must not be driven, tell the operator's program; 50 times a second."""
        for packet in self._link.receive():
            self.picture.take(packet)
            self.camera.take(packet)
            if packet.key == self._camera_key:
                self._sight.note(packet.arrived_ns)
        self.camera.look(self.picture, now_ns)
        if self.picture.state is not None:
            self.seat.robot_shows(estop=self.picture.state.mode == "estop")
        picture = self.picture
        self._short = self._following.note(picture.report, picture.state, picture.ages(now_ns)[1], now_ns)
        now = self._situation(now_ns)
        self.seat.lock(lost(now))
        stopped = now.state is not None and now.state.mode in ("estop", "stopped")
        self._absence.note(unheard(now), now_ns, pressed=now.holds, stopped=stopped)
        self._tell(now_ns)

    def hear(self, number: int, said: Ordered, now_ns: int) -> bool:
        """Take what a page says, and pass it on at once; False where it must go."""
        stays = self.seat.hear(number, said, now_ns)
        self._change_network()
        self._tell(now_ns)
        return stays

    def leave(self, number: int, now_ns: int) -> None:
        """A page is gone."""
        self.seat.leave(number)
        self.camera.leave(number)
        self._tell(now_ns)

    def frame(self, number: int, now_ns: int) -> dict[str, Any]:
        """What page `number` is told of one instant."""
        return frame(self.picture, self.seat, self._situation(now_ns), self.network, number, now_ns)

    def _situation(self, now_ns: int) -> Situation:
        if not self.seat.holds(now_ns):
            self._idle_ns = now_ns
        network = self.network
        now = situation(
            self.picture,
            self.seat,
            now_ns,
            frozen=self._sight.frozen(now_ns),
            outage=network is not None and network.outage,
            was_lost=self._absence.was_lost,
        )
        return replace(now, short=self._short, held_for=(now_ns - self._idle_ns) * 1e-9)

    def _change_network(self) -> None:
        change, self.seat.change = self.seat.change, None
        told = self.network
        if change is None or told is None or self._network is None:
            return
        if not isinstance(change, ChooseNetwork):
            self._network.cut(change.seconds)
        elif change.name in told.names:
            self._network.choose(change.name)

    def _tell(self, now_ns: int) -> None:
        self._sender.send(self.seat.wish(now_ns), now_ns, drives=self.seat.driver != 0)
