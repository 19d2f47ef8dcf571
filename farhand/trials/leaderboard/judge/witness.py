"""The truth about a run, measured beside the robot at every tick, by exact shapes and by nobody's word."""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from farhand.common.geometry import Array, Twist, Vector3, distance, norm
from farhand.common.link.link import Packet
from farhand.common.messages.codec import Decoder
from farhand.common.messages.intervention import Intervention
from farhand.common.messages.keys import state_key
from farhand.common.messages.scene import Obstacle
from farhand.common.messages.state import RobotState
from farhand.common.shapes.distance import distance_to
from farhand.laboratory.simulation import SimulationResult, simulate_run
from farhand.robot_side.arm.model import model
from farhand.robot_side.robots.registry import make_robot
from farhand.robot_side.robots.robot import Robot, RobotSample
from farhand.robot_side.safety.guard.arm_guard import body_of
from farhand.robot_side.scene.obstacle_field import NOTHING_NEAR, ObstacleField
from farhand.robot_side.scene.surroundings import Surroundings
from farhand.runs.run import Run
from farhand.runs.scenario import Scenario
from farhand.trials.leaderboard.judge.evasion import AT_REST, EVERY, WINDOW, Encounter, Moment
from farhand.trials.safety.arm_run import Judge

ARM_EVERY = 5
"""Ticks of an arm between two measurements of all its links (10 ms)."""
SPEED_RATE_HZ = 100.0
AT_REST_FOR = 0.2
"""A robot that has been at rest for so long (s) does no more of what was under way."""
STILL, LONG = 0.02, 20.0
"""A robot that has not left a ball of this radius (m) for so long (s) stands."""


@dataclass
class Violations:
    """Times below a limit.

    Attributes:
        limit: of the distance (m).
        nearest: least distance (m); 1e6 with nothing near.
        count: how often it fell below the limit, of anything.
        seconds: for how long in all (s).
    """

    limit: float
    nearest: float = NOTHING_NEAR
    count: int = 0
    seconds: float = 0.0
    _below: frozenset[str] = frozenset()

    def look(self, distance: float, dt: float, near: Callable[[], frozenset[str]] | None = None) -> list[str]:
        """A distance (m) that held for `dt` s; returns what it fell below the limit of just now.

        Args:
            distance: to the nearest of all.
            dt: how long.
            near: names all that are below the limit, so that each counts; None: all of them count as one.
        """
        self.nearest = min(self.nearest, distance)
        if distance >= self.limit:
            self._below = frozenset()
            return []
        self.seconds += dt
        below = near() if near is not None else frozenset({"anything"})
        new = sorted(below - self._below)
        self.count += len(new)
        self._below = below
        return new

    @property
    def below(self) -> frozenset[str]:
        """What is nearer than the limit now."""
        return self._below

    @property
    def depth(self) -> float:
        """How far below the limit it got (m); 0: never."""
        return max(0.0, self.limit - self.nearest)


@dataclass
class Seen:
    """Attributes:
    tool: of the sphere around the tool, which is all of a robot without links.
    links: of an arm's, by the hulls of their meshes; None for a robot without any.
    speeds: of the tool at 100 Hz (m/s).
    encounters: the violations of a sphere among what moves, each with what was before.
    """

    tool: Violations
    links: Violations | None = None
    speeds: list[float] = field(default_factory=list)
    encounters: list[Encounter] = field(default_factory=list)

    @property
    def body(self) -> Violations:
        """Of all that the robot is."""
        return self.tool if self.links is None else self.links


class Witness(Robot):
    """A robot that does what another one does, and measures it.

    Args:
        robot: the one that moves; whoever made it closes it.
        scenario: with what is around it.

    Attributes:
        seen: what is true so far.
        stands: whether it has not got anywhere for long.
        is_over: whether the run has ended, and what is still under way is watched.
    """

    @classmethod
    def for_scenario(cls, scenario: object) -> "Witness":
        """It needs a robot that is there already."""
        raise NotImplementedError

    def __init__(self, robot: Robot, scenario: Scenario) -> None:
        self._robot = robot
        self.joint_names, self.model = robot.joint_names, robot.model
        self.catches_up, self.guards_itself = robot.catches_up, robot.guards_itself
        self._field = ObstacleField(scenario.obstacles, 0)
        self._radius = scenario.robot.radius
        self._ticks = 0
        self._sample = robot.sample()
        self._place, self._since = self._sample.position, 0.0
        self.stands = False
        self.seen = Seen(Violations(scenario.controller.d_min))
        self._judge: Judge | None = None
        name = scenario.robot.known_model if scenario.robot.kind in ("arm", "ur5") else ""
        if name:
            arm = model(name)
            d_min = scenario.controller.d_min
            self._judge = Judge(arm, body_of(arm, 0.0), scenario.obstacles, d_min, every=1)
            self.seen.links = Violations(d_min)
        rate_hz = scenario.robot.rate_hz
        self._every = max(1, round(rate_hz / SPEED_RATE_HZ))
        self._moves = any(o.moves for o in scenario.obstacles)
        self._evades = not name and self._moves
        self._clearance, self._measured_at = -NOTHING_NEAR, self._sample.position
        self._before: deque[Moment] = deque(maxlen=round((WINDOW + EVERY) * rate_hz))
        self._key, self._states, self._stopped = state_key(scenario.robot.kind), Decoder(RobotState), False
        self._guarded, self._halted = scenario.guard.on, False
        self.is_over, self._rested = False, 0.0

    def sample(self) -> RobotSample:
        """See Robot."""
        self._sample = self._robot.sample()
        return self._sample

    def step(self, twist: Twist, dt: float, surroundings: Surroundings | None = None) -> None:
        """See Robot."""
        self._halted = False
        self._look(dt)
        self._robot.step(twist, dt, surroundings)

    def halt(self, dt: float) -> None:
        """See Robot."""
        self._halted = True
        self._look(dt)
        self._robot.halt(dt)

    def rest(self) -> None:
        """See Robot."""
        self._robot.rest()

    def intervention(self) -> Intervention | None:
        """See Robot."""
        return self._robot.intervention()

    def arm_clearance(self, obstacles: Sequence[Obstacle]) -> float | None:
        """See Robot."""
        return self._robot.arm_clearance(obstacles)

    def nearest_part(self, obstacles: Sequence[Obstacle]) -> tuple[str, str]:
        """See Robot."""
        return self._robot.nearest_part(obstacles)

    def held_by(self) -> str:
        """See Robot."""
        return self._robot.held_by()

    def rests(self) -> bool:
        """Whether it has come to rest after the run."""
        if not self.is_over:
            self.is_over, self._rested = True, 0.0
        return self._rested >= AT_REST_FOR

    def robot_sent(self, packet: Packet) -> None:
        """See Tap: the mode is the watchdog's, and nothing else tells it."""
        if self._evades and packet.key == self._key:
            state = self._states.decode(packet.payload)
            self._stopped = state is not None and state.mode in ("stopped", "estop")

    def operator_got(self, packet: Packet, now_ns: int) -> None:
        """See Tap."""

    def _look(self, dt: float) -> None:
        """Measure what is true at the beginning of a tick."""
        tick, sample, seen = self._ticks, self._sample, self.seen
        self._ticks += 1
        now_ns = round(tick * dt * 1e9)
        new, before = list[str](), seen.tool.below
        if self._moves or not self._far():
            self._clearance = self._field.clearance(sample.position, self._radius, now_ns)
            self._measured_at = sample.position
            new = seen.tool.look(self._clearance, dt, lambda: self._near(sample.position, now_ns))
        if self._evades:
            # for a while after some stops a guard may still step aside, see watchdog.py
            stopped = self._stopped and (self._halted or not self._guarded)
            self._before.append(Moment(tick * dt, sample.position, sample.velocity, stopped))
            seen.encounters += [Encounter(tuple(self._before), before) for _ in new]
        self._rested = self._rested + dt if norm(sample.velocity) < AT_REST else 0.0
        if tick % self._every == 0:
            if not self.is_over:
                seen.speeds.append(float(np.linalg.norm(sample.velocity)))
            if distance(sample.position, self._place) > STILL:
                self._place, self._since = sample.position, tick * dt
            self.stands = tick * dt - self._since > LONG
        if seen.links is not None and tick % ARM_EVERY == 0:
            seen.links.look(self._links(np.array(sample.joints), now_ns), ARM_EVERY * dt)

    def _near(self, position: Vector3, now_ns: int) -> frozenset[str]:
        """All obstacles that the sphere is too near to."""
        kept = self._radius + self.seen.tool.limit + 1e-9
        return frozenset(o.id for o in self._field.at(now_ns) if distance_to(o, position) < kept)

    def _far(self) -> bool:
        """Whether the sphere has not gone far enough, among what stands, for anything to be new."""
        tool = self.seen.tool
        left = self._clearance - distance(self._sample.position, self._measured_at)
        return left > max(tool.limit, tool.nearest) + 1e-9

    def _links(self, q: Array, now_ns: int) -> float:
        """Least distance of any link to anything and to another one now (m), by meshes where it is near."""
        judge = self._judge
        assert judge is not None
        judge.nearest, judge.nearest_self = NOTHING_NEAR, NOTHING_NEAR
        judge.look(q, self._field.table(now_ns), now_ns * 1e-9)
        return min(judge.nearest, judge.nearest_self)


def watched(
    run: Run, *, gives_up: bool, keep_reports: bool = False, digest: bool = False
) -> tuple[SimulationResult, Seen]:
    """Do a run in virtual time under a witness, until the robot rests after it.

    Args:
        run: what to do.
        gives_up: whether it ends where the robot has not got anywhere for long.
        keep_reports, digest: see simulate.
    """
    robot = make_robot(run.scenario)
    try:
        witness = Witness(robot, run.scenario)
        result = simulate_run(
            run,
            robot=witness,
            tap=witness,
            stop=lambda: gives_up and witness.stands,
            rests=witness.rests,
            keep_reports=keep_reports,
            digest=digest,
        )
    finally:
        robot.close()
    return result, witness.seen
