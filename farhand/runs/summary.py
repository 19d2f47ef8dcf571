"""The summary of a run: was it safe, did it finish, and how did the network do."""

import json
import math
from collections.abc import Iterable, Sequence
from pathlib import Path

import msgspec

from farhand.common.errors import ResultError
from farhand.common.messages.base import SafetyMode
from farhand.common.result_file import write_whole
from farhand.operator_side.accounts.result import OperatorResult
from farhand.operator_side.pace import pace_of
from farhand.operator_side.steering.registry import DEVICES
from farhand.robot_side.result import GuardedPair, RobotResult
from farhand.runs.files import SUMMARY
from farhand.runs.results import Counts, RunResults
from farhand.runs.run import Run
from farhand.runs.slowness import slowness
from farhand.runs.why import too_near


class RunSummary(msgspec.Struct, frozen=True, kw_only=True):
    """SI units. The figures that decide stand here by name; every counter of the programs stands in `counts`.

    Attributes:
        safe: the true clearance is known never to have fallen below d_min, and no link of an arm to have touched an
            obstacle; of a run in which no state of the robot arrived nothing is known to be safe.
        driven: whether the operator's side ever had a state of the robot; None: it left no result.
        too_near: part and obstacle that came too near, in words; empty otherwise.
        finished: all targets are known to have been reached within the time limit.
        min_clearance: smallest true clearance of the robot's safety sphere (m); None without obstacles.
        min_arm_clearance: smallest true distance of the whole arm to an obstacle (m), where computed.
        d_min: distance to keep (m).
        duration: from the first motion command to the last target, or to the end (s).
        rtt_mean, rtt_std: measured network round trip with computing (s).
        interventions: ticks in which something binds or a reason stands (see ControlReport.intervening).
        infeasible: ticks in which the solver found no plan that meets every constraint.
        stops: latched stops of the robot.
        began: when the robot got its first motion command (s since its first tick): zero of all times here.
        interruptions: (t, mode, reason) of stops, and of holds for want of commands; s since the first motion command.
        radius: of the sphere around the tool that must stay clear (m).
        nearest_obstacle: to which the tool's sphere came nearest.
        guard_pairs: part and obstacle for whose sake the guard on the robot acted, longest first.
        nearest_part, nearest_to_arm: the part of the arm that came nearest to an obstacle, and that obstacle.
        period: of a control tick (s).
        lag: of the robot's velocity response, as the scenario says (s).
        acknowledges_itself: whether the steering device acknowledges stops without a person.
        refused: commands that the robot refused.
        refused_by: the same by reason.
        solver: what solved.
        real_time: run against the wall clock, as separate programs.
        why: what went wrong, in words; empty otherwise.
        slow: that the machine did not keep up, in words; empty otherwise, and in virtual time.
        counts: all that operator, netem and robot counted and measured.
    """

    safe: bool
    finished: bool
    min_clearance: float | None
    min_arm_clearance: float | None
    d_min: float
    duration: float
    rtt_mean: float | None
    rtt_std: float | None
    interventions: int
    infeasible: int
    stops: int
    refused: int
    refused_by: dict[str, int]
    ticks: int
    targets_reached: int
    targets: int
    path_length: float
    seed: int
    scenario: str
    robot: str
    uplink: str
    downlink: str
    margin: str
    predictor: str
    controller: str
    solver: str
    real_time: bool
    why: str = ""
    slow: str = ""
    driven: bool | None = None
    too_near: str = ""
    began: float | None = None
    interruptions: list[tuple[float, SafetyMode, str]] = msgspec.field(default_factory=list)
    radius: float = 0.0
    nearest_obstacle: str = ""
    nearest_part: str = ""
    nearest_to_arm: str = ""
    guard_pairs: list[GuardedPair] = msgspec.field(default_factory=list)
    period: float = 0.1
    lag: float | None = None
    acknowledges_itself: bool = False
    counts: Counts = Counts()

    @property
    def exit_code(self) -> int:
        """0 safe and finished, else 1."""
        return 0 if self.safe and self.finished else 1

    @property
    def safety_known(self) -> bool:
        """Whether `safe` is a fact: without the robot's result, it is false because nothing is known."""
        return self.counts.robot is not None

    @property
    def end_known(self) -> bool:
        """Whether `finished`, the targets and all that the operator's side counts are facts; likewise."""
        return self.counts.operator is not None

    @property
    def network(self) -> str:
        """`5g-urban`, or `UPLINK / DOWNLINK` where they differ."""
        return self.uplink if self.uplink == self.downlink else f"{self.uplink} / {self.downlink}"


_NOTHING = RobotResult(min_clearance=None, ticks=0, stops=0)
"""What is known of a robot whose program left no result."""


def summarise(run: Run, results: RunResults, *, real_time: bool, why: str = "") -> RunSummary:
    """Put a run's results together; the robot's own is the truth about clearance.

    A program that left no result has counted nothing, and nothing is known to be safe without the robot's, or where
    it measured no clearance though there are obstacles.
    """
    scenario = run.scenario
    robot = results.robot if results.robot is not None else _NOTHING
    operator = results.operator
    if operator is None:
        operator = OperatorResult(finished=False, solver=str(scenario.controller.solver))
    d_min = scenario.controller.d_min
    clear = robot.min_clearance is None or robot.min_clearance >= d_min
    free = robot.min_arm_clearance is None or robot.min_arm_clearance > 0
    last = operator.last_report
    driven = None if results.operator is None else operator.finished or (last is not None and last.states > 0)
    measured = robot.ticks > 0 and (robot.min_clearance is not None or not scenario.obstacles)
    known = measured and driven is not False
    near = too_near(robot, d_min)
    counts, period = results.counts(), pace_of(scenario).tick
    began = robot.began if robot.began is not None else motion_start(robot.trajectory)
    return RunSummary(
        safe=known and clear and free,
        finished=operator.finished,
        min_clearance=robot.min_clearance,
        min_arm_clearance=robot.min_arm_clearance,
        d_min=d_min,
        duration=operator.duration,
        rtt_mean=operator.rtt_mean,
        rtt_std=operator.rtt_std,
        interventions=operator.interventions,
        infeasible=operator.infeasible,
        stops=robot.stops,
        refused=sum(robot.refused.values()),
        refused_by=robot.refused,
        ticks=operator.ticks,
        targets_reached=last.target_index if last is not None else 0,
        targets=(last.target_count if last is not None else 0) or len(scenario.targets),
        path_length=robot.path_length,
        seed=run.seed,
        scenario=scenario.name,
        robot=scenario.robot.kind,
        uplink=run.network.uplink.text,
        downlink=run.network.downlink.text,
        margin=scenario.margin.kind,
        predictor=scenario.predictor,
        controller=scenario.controller.kind,
        solver=operator.solver,
        real_time=real_time,
        why=why,
        slow=slowness(counts, str(run.network), period) if real_time else "",
        driven=driven,
        too_near=near,
        began=began,
        lag=scenario.robot.lag,
        interruptions=[(t - began, mode, reason) for t, mode, reason in robot.interruptions],
        radius=scenario.robot.radius,
        nearest_obstacle=robot.nearest_obstacle,
        nearest_part=robot.nearest_part,
        nearest_to_arm=robot.nearest_to_arm,
        guard_pairs=robot.guard_pairs,
        period=period,
        acknowledges_itself=DEVICES.get(scenario.steering.kind, "steering.kind").acknowledges_itself,
        counts=counts,
    )


def motion_start(trajectory: Sequence[Sequence[float]]) -> float:
    """When the tool had left its start by a millimetre (s since the robot's first tick); else its beginning.

    In place of the first motion command, where the robot does not say when it came.
    """
    if not trajectory:
        return 0.0
    start = trajectory[0][1:4]
    return next((row[0] for row in trajectory if math.dist(row[1:4], start) > 1e-3), trajectory[0][0])


def to_json(summary: RunSummary) -> str:
    """One line of JSON."""
    return msgspec.json.encode(summary).decode()


def write_summary(summary: RunSummary, folder: Path) -> Path:
    """Write `summary.json` into a run's folder."""
    path = folder / SUMMARY
    write_whole(path, json.dumps(msgspec.to_builtins(summary), indent=1) + "\n")
    return path


def read_summary(folder: Path) -> RunSummary | None:
    """The summary in a folder; None: there is none. Raises ResultError with what is wrong with it."""
    path = folder / SUMMARY
    try:
        if path.exists() and not path.is_file():
            raise ResultError(f"{SUMMARY} cannot be read: it is no file")
        return msgspec.json.decode(path.read_bytes(), type=RunSummary)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise ResultError(f"{SUMMARY} cannot be read: {error.strerror or error}") from None
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise ResultError(f"{SUMMARY} cannot be read: {error}") from None


def count_reasons(items: Iterable[tuple[str, int]]) -> str:
    """`old-seq 3, stale 1` for people."""
    return ", ".join(f"{reason} {n}" for reason, n in sorted(items)) or "none"
