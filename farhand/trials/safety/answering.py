"""How soon a robot answers a hand: from a change of the wish to the first command, and the first period, that know it.

A point robot in the open, over a network, steered to and fro: the hand turns round at instants that have nothing to do
with ticks. In virtual time both clocks are one, so that the two ends can be compared.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import msgspec

from farhand.common.geometry import Twist
from farhand.common.messages.base import Vector3
from farhand.common.seeds import stream
from farhand.laboratory.simulation import START_NS, SimulationResult, simulate_run
from farhand.operator_side.control.settings import ControllerSettings
from farhand.operator_side.steering.device import SteeringDevice, SteeringInput, View
from farhand.operator_side.steering.registry import DEVICES
from farhand.robot_side.robots.point import PointRobot
from farhand.robot_side.robots.registry import make_robot
from farhand.robot_side.robots.robot import Robot
from farhand.runs.run import Run
from farhand.runs.scenario import Scenario, replace_settings
from farhand.trials.safety.rates import Rate, with_rate

NAME = "to-and-fro"
SPEED = 0.2
"""m/s."""
LENGTH = 120.0
"""Of a drive (s)."""
APART = (2.0, 3.0)
"""Between two turns (s): more than any round trip that is answered."""
FAR: Vector3 = (1000.0, 0.0, 0.0)
_SECOND_NS = 1_000_000_000


@dataclass(frozen=True, slots=True)
class Answers:
    """Of the turns that were answered before the next one.

    Attributes:
        turns: all there were.
        commands: from turn to the command that leaves, computing included (s), sorted.
        robots: from turn to the first period in which the robot is told so (s), sorted.
    """

    turns: int
    commands: tuple[float, ...]
    robots: tuple[float, ...]


def turns(seed: int) -> list[int]:
    """The instants at which the hand turns round (ns)."""
    draw, now, found = stream(seed, "turns"), START_NS + _SECOND_NS, []
    while now < START_NS + LENGTH * _SECOND_NS:
        now += round(float(draw.uniform(*APART)) * _SECOND_NS)
        found.append(now)
    return found


class ToAndFro(SteeringDevice):
    """Forward, back, forward, ...; clears every stop, as the drive goes on for as long as it is said."""

    def __init__(self, settings: Any = None) -> None:
        super().__init__(settings)
        self.turns: list[int] = []

    def read(self, view: View) -> SteeringInput:
        """See SteeringDevice."""
        self.turns = self.turns or turns(0)
        back = bisect_right(self.turns, view.now_ns) % 2
        stopped = view.state.mode == "stopped"
        return SteeringInput((-SPEED if back else SPEED, 0.0, 0.0), engaged=True, acknowledge=stopped)


class Noting(PointRobot):
    """A point that notes what it is told, period by period."""

    def __init__(self, robot: PointRobot) -> None:
        self.__dict__ = robot.__dict__
        self.told: list[float] = []

    def step(self, twist: Twist, dt: float, around: Any = None) -> None:
        """See Robot."""
        self.told.append(twist.linear[0])
        super().step(twist, dt)


if NAME not in DEVICES:
    DEVICES.add(NAME, ToAndFro)


def drive(network: str, rate: Rate, computing_time: float, seed: int = 0) -> Answers:
    """One drive; raises InputError for a network that is none."""
    scenario = Scenario(
        name=NAME,
        description="to and fro in the open",
        start=(0.0, 0.0, 0.0),
        targets=(FAR,),
        obstacles=(),
        controller=ControllerSettings(speed_limit=(0.5, 0.5, 0.5)),
    )
    settings = {"steering.kind": NAME, "robot.kind": "point", "robot.rate_hz": 500.0, "robot.lag": 0.1}
    scenario = with_rate(replace_settings(scenario, settings), rate)
    run = msgspec.structs.replace(
        Run.over(scenario, network, seed=seed), time_limit=LENGTH, computing_time=(computing_time,)
    )
    robot: Robot = make_robot(scenario)
    assert isinstance(robot, PointRobot)
    noting = Noting(robot)
    result = simulate_run(run, keep_reports=True, robot=noting)
    period_ns = round(_SECOND_NS / scenario.robot.rate_hz)
    return answers_of(turns(0), result, noting.told, period_ns, computing_time)


def answers_of(
    turned: Sequence[int], result: SimulationResult, told: Sequence[float], period_ns: int, computing: float
) -> Answers:
    """What the two ends show.

    Args:
        turned: the turns (ns).
        result: of the drive, with its reports.
        told: velocity that the robot was told, in each of its periods (m/s).
        period_ns: of the robot.
        computing: from the beginning of a tick to its command (s).
    """
    sent = [report.t_sent_ns for report in result.reports]
    ended_ns = START_NS + len(told) * period_ns
    commands, robots, count = [], [], 0
    for index, turn_ns in enumerate(turned):
        until_ns = turned[index + 1] if index + 1 < len(turned) else ended_ns
        if until_ns > ended_ns:
            break
        count += 1
        sign = -1.0 if index % 2 == 0 else 1.0
        for report in result.reports[bisect_left(sent, turn_ns) : bisect_left(sent, until_ns)]:
            if report.mode == "run" and report.filtered[0] * sign > 0.0:
                commands.append((report.t_sent_ns - turn_ns) * 1e-9 + computing)
                break
        first = -(-(turn_ns - START_NS) // period_ns)
        for k in range(first, (until_ns - START_NS) // period_ns):
            if told[k] * sign > 0.0:
                robots.append((k - first) * period_ns * 1e-9)
                break
    return Answers(count, tuple(sorted(commands)), tuple(sorted(robots)))
