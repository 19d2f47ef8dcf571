"""The summary of a run: was it safe, did it finish, and how did the network do."""

import json
import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import msgspec

from farhand.common.messages.report import ControlReport
from farhand.runs.scenario import Scenario

NO_OBSTACLE = 1e5


class RunSummary(msgspec.Struct, frozen=True, kw_only=True):
    """SI units.

    Attributes:
        safe: the true clearance never fell below d_min, and no link of an arm touched an obstacle.
        finished: all targets were reached within the time limit.
        min_clearance: smallest true clearance of the robot's safety sphere (m); None without obstacles.
        min_arm_clearance: smallest true distance of the whole arm to an obstacle (m), where computed.
        d_min: distance to keep (m).
        duration: from the first motion command to the last target, or to the end (s).
        rtt_mean, rtt_std: measured network round trip with computing (s).
        interventions: ticks in which an obstacle or a failed solve changed the command.
        infeasible: ticks in which the solver found no plan that meets every constraint.
        stops: latched stops of the robot.
        refused: commands that the robot refused.
        refused_by: the same by reason.
        solver: what solved.
        real_time: run against the wall clock, as separate programs.
        why: what went wrong, in words; empty otherwise.
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

    @property
    def exit_code(self) -> int:
        """0 safe and finished, else 1."""
        return 0 if self.safe and self.finished else 1


class Tally:
    """Counts what the reports of a run say."""

    def __init__(self) -> None:
        self.ticks = 0
        self.interventions = 0
        self.infeasible = 0
        self.last: ControlReport | None = None

    def add(self, report: ControlReport) -> None:
        """Count one tick."""
        self.ticks += 1
        self.interventions += report.intervening
        self.infeasible += report.status not in ("optimal", "shortcut", "idle")
        self.last = report


def summarise(
    scenario: Scenario,
    *,
    seed: int,
    uplink: str,
    downlink: str,
    tally: Tally,
    robot: dict[str, Any],
    finished: bool,
    duration: float,
    rtt: tuple[float | None, float | None],
    solver: str,
    real_time: bool,
    why: str = "",
) -> RunSummary:
    """Put a run's results together; `robot` is the robot node's own summary, the truth about clearance."""
    clearance = robot.get("min_clearance")
    if clearance is not None and (clearance > NO_OBSTACLE or not math.isfinite(clearance)):
        clearance = None
    arm = robot.get("min_arm_clearance")
    known = "min_clearance" in robot
    d_min = scenario.controller.d_min
    safe = known and (clearance is None or clearance >= d_min) and (arm is None or arm > 0)
    refused = dict(robot.get("refused", {}))
    reached, count = (tally.last.target_index, tally.last.target_count) if tally.last else (0, 0)
    return RunSummary(
        safe=safe,
        finished=finished,
        min_clearance=clearance,
        min_arm_clearance=arm,
        d_min=d_min,
        duration=duration,
        rtt_mean=rtt[0],
        rtt_std=rtt[1],
        interventions=tally.interventions,
        infeasible=tally.infeasible,
        stops=int(robot.get("stops", 0)),
        refused=sum(refused.values()),
        refused_by=refused,
        ticks=tally.ticks,
        targets_reached=reached,
        targets=count or len(scenario.targets),
        path_length=float(robot.get("path_length", 0.0)),
        seed=seed,
        scenario=scenario.name,
        robot=scenario.robot.kind,
        uplink=uplink,
        downlink=downlink,
        margin=scenario.margin.kind,
        predictor=scenario.predictor,
        controller=scenario.controller.kind,
        solver=solver,
        real_time=real_time,
        why=why,
    )


def to_json(summary: RunSummary) -> str:
    """One line of JSON."""
    return msgspec.json.encode(summary).decode()


def write_summary(summary: RunSummary, folder: Path) -> Path:
    """Write `summary.json` into a run's folder."""
    path = folder / "summary.json"
    path.write_text(json.dumps(msgspec.to_builtins(summary), indent=1) + "\n", encoding="utf-8")
    return path


def count_reasons(items: Iterable[tuple[str, int]]) -> str:
    """`old-seq 3, stale 1` for people."""
    return ", ".join(f"{reason} {n}" for reason, n in sorted(items)) or "none"
