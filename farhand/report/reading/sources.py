"""Figures that more than one can tell: whose word is taken, so that each figure is of one source.

The robot's result is taken for what the robot counted and measured, the operator's for task and duration; the
recording for all else, and for these where a program left no result.
"""

import numpy as np

from farhand.operator_side.accounts.result import OperatorCounts
from farhand.report.reading.evidence import Evidence

ROBOT, OPERATOR = "robot's result", "operator's result"
OF_ROBOT = ("clearance", "arm_clearance", "guard", "stops", "refused", "refused_by", "robot_loop")
OF_OPERATOR = ("finished", "targets_reached", "targets", "duration", "overruns", "filtered_ticks")


def sources_of(run: Evidence) -> dict[str, str]:
    """Whose word a figure is, by its name, where it is not the recording's."""
    found: dict[str, str] = {}
    if run.robot is not None:
        found |= dict.fromkeys(OF_ROBOT, ROBOT)
        if run.summary is not None:
            found["safe"] = ROBOT
    if operator_of(run) is not None:
        found |= dict.fromkeys(OF_OPERATOR, OPERATOR)
    return found


def operator_of(run: Evidence) -> OperatorCounts | None:
    """What the operator's side counted; None: unknown."""
    return run.summary.counts.operator if run.summary is not None else None


def duration_of(run: Evidence) -> float | None:
    """From the first motion command to the end (s); None: there was none, or it is not known when."""
    operator = operator_of(run)
    if operator is not None:
        return operator.duration or None
    return run.story.driven


def targets_of(run: Evidence) -> tuple[int, int] | None:
    """Reached, and in all; None: unknown."""
    if run.summary is not None and operator_of(run) is not None:
        return run.summary.targets_reached, run.summary.targets
    last = run.story.last
    return (last.target_index, last.target_count) if last is not None and last.target_count else None


def overruns_of(run: Evidence) -> int | None:
    """The operator's late ticks."""
    operator, last = operator_of(run), run.story.last
    if operator is not None:
        return operator.overruns
    return last.overruns if last is not None else None


def clearance_of(run: Evidence) -> float | None:
    """The least of the tool's sphere (m), at the robot's own rate; obstacles that are not there are no distance."""
    told = run.robot.min_clearance if run.robot is not None else run.story.least
    story = run.story
    return None if told is None or (story.scene is not None and not story.had_obstacles) else told


def arm_of(run: Evidence) -> float | None:
    """The least of the whole arm (m)."""
    if run.robot is not None:
        return run.robot.min_arm_clearance
    arm = run.story.states["arm"]
    return float(np.nanmin(arm)) if np.isfinite(arm).any() else None


def stops_of(run: Evidence) -> int | None:
    """That latched."""
    if run.robot is not None:
        return run.robot.stops
    last = run.story.last
    return last.stops if last is not None and last.states else None


def emulator_of(run: Evidence) -> dict[str, tuple[int, int]]:
    """Messages with copies, and how many were lost, by direction; empty: it left no result."""
    netem = run.summary.counts.netem if run.summary is not None else None
    if netem is None:
        return {}
    ways = {"downlink": netem.downlink, "uplink": netem.uplink}
    return {name: (way.received + way.duplicated, sum(way.dropped.values())) for name, way in ways.items()}


def refused_of(run: Evidence) -> int | None:
    """Commands that the robot refused."""
    if run.robot is not None:
        return sum(run.robot.refused.values())
    last = run.story.last
    return last.refused_there if last is not None and last.states else None


def safe_of(run: Evidence, limit: float | None) -> bool | None:
    """By the robot's result; without one only what the recording shows to be unsafe is known."""
    if run.summary is not None and run.summary.safety_known:
        return run.summary.safe
    clearance, arm = clearance_of(run), arm_of(run)
    near = limit is not None and clearance is not None and clearance < limit
    return False if near or (arm is not None and arm <= 0.0) else None
