"""One run of the leaderboard in virtual time, and its row."""

from collections.abc import Sequence

import msgspec
import numpy as np

from farhand.common.messages.base import Vector3
from farhand.common.messages.report import ControlReport
from farhand.laboratory.campaigns.jobs import DIGEST_DIGITS
from farhand.laboratory.simulation import SimulationResult
from farhand.runs.run import Run
from farhand.runs.scenario import Scenario, scenario_from_table
from farhand.runs.why import INTERRUPTED
from farhand.trials.leaderboard.judge.evasion import judged
from farhand.trials.leaderboard.judge.smoothness import spectral_arc_length
from farhand.trials.leaderboard.judge.witness import SPEED_RATE_HZ, Seen, watched
from farhand.trials.leaderboard.methods.code import check_code
from farhand.trials.leaderboard.methods.method import Method, applied, method_named
from farhand.trials.leaderboard.plan.networks import check_content
from farhand.trials.leaderboard.plan.operators import OPERATORS
from farhand.trials.leaderboard.plan.rows import Row, Spec, lost, row_of
from farhand.trials.leaderboard.wall_limit import wall_limit

PATIENCE, SPARE = 4.0, 20.0
"""A run may take so many times as long as the ideal operator's, and so many seconds more."""
LONGEST = 900.0
"""What a run may take of real time (s): a method that hangs costs its row, and not the table."""
STUCK = "stood still for 20 s: given up"
CHANGED = 0.02
"""The operator's side changed the wish where it commands a velocity that differs by more (m/s)."""


def run_all(specs: list[Spec]) -> list[Row]:
    """A chunk of runs, as sent to a worker."""
    return [run_one(spec) for spec in specs]


def run_one(spec: Spec) -> Row:
    """Run it; what raises becomes a row with `error`."""
    try:
        return witnessed(spec)
    except Exception as error:  # a campaign of thousands must outlive one crash; the row names its seed
        return lost(spec, f"{type(error).__name__}: {error}")


def run_of(spec: Spec, method: Method) -> Run:
    """What is simulated; raises InputError."""
    scenario = scenario_from_table(spec.task.scenario, f"task {spec.task.key}")
    scenario = OPERATORS[spec.operator].applied_to(scenario, spec.seed)
    scenario = applied(method, scenario)
    limit = PATIENCE * (spec.task.duration or 0.0) + SPARE
    return msgspec.structs.replace(Run.over(scenario, spec.spec, seed=spec.seed), time_limit=limit)


def witnessed(spec: Spec) -> Row:
    """The row of a run; raises what it raises."""
    check_code(spec.method, spec.key)
    check_content(spec.network, spec.spec, spec.key)
    method = method_named(spec.method)
    with method.known(), wall_limit(LONGEST):
        run = run_of(spec, method)
        gives_up = OPERATORS[spec.operator].finishes
        result, seen = watched(run, gives_up=gives_up, keep_reports=True, digest=True)
    return _row(spec, result, seen, run.scenario)


def _row(spec: Spec, result: SimulationResult, seen: Seen, scenario: Scenario) -> Row:
    summary = result.summary
    body = seen.body
    verdict = judged(body.count, seen.encounters, scenario)
    safe = bool(summary.driven) and not body.count
    if result.fault:
        return lost(spec, f"the operator's program faulted: {result.fault}")
    stuck = summary.why == INTERRUPTED
    share, strength = _filtered(result.reports, scenario.controller.speed_limit)
    robot = summary.counts.robot
    guarded = robot.guard_seconds if robot is not None else 0.0
    return msgspec.structs.replace(
        row_of(spec),
        success=safe and (summary.finished or not OPERATORS[spec.operator].finishes),
        safe=safe,
        finished=summary.finished,
        violations=body.count,
        evadable=verdict.evadable,
        run_over=verdict.run_over,
        violation_depth=body.depth,
        violation_seconds=body.seconds,
        min_clearance=body.nearest,
        min_tool_clearance=seen.tool.nearest,
        duration=summary.duration,
        ideal_duration=spec.task.duration,
        path_length=summary.path_length,
        ideal_path=spec.task.path_length,
        filtered_share=share,
        filtered_strength=strength,
        guard_share=guarded / summary.duration if summary.duration > 0.0 else 0.0,
        guard_strength=_guarded(result.reports),
        stops=summary.stops,
        infeasible=summary.infeasible,
        refused=summary.refused,
        smoothness=spectral_arc_length(seen.speeds, SPEED_RATE_HZ),
        rtt_mean=summary.rtt_mean,
        digest=result.digest[:DIGEST_DIGITS],
        why=STUCK
        if stuck
        else summary.why
        if not summary.finished and OPERATORS[spec.operator].finishes
        else "",
    )


def _filtered(reports: Sequence[ControlReport], limit: Vector3) -> tuple[float, float]:
    """Share of the ticks of motion in which the wish was changed, and the changes over the wishes.

    Args:
        reports: of all ticks.
        limit: of the speed in each axis (m/s): what is beyond it, no method can do.
    """
    driven = [report for report in reports if report.mode == "run"]
    if not driven:
        return 0.0, 0.0
    desired = np.clip([report.desired for report in driven], -np.array(limit), np.array(limit))
    changes = np.linalg.norm(desired - np.array([report.filtered for report in driven]), axis=1)
    wishes = float(np.linalg.norm(desired, axis=1).sum())
    return float(np.mean(changes > CHANGED)), float(changes.sum()) / wishes if wishes else 0.0


def _guarded(reports: Sequence[ControlReport]) -> float | None:
    """By how much the guard on the robot changed the speed, mean over the ticks that report it (m/s)."""
    changes = [abs(r.guard.asked - r.guard.done) for r in reports if r.guard is not None]
    return sum(changes) / len(changes) if changes else None
