"""Why a run is no good, in words: what kept it from its end, and what came too near."""

from farhand.common.messages.report import ControlReport
from farhand.robot_side.result import RobotResult
from farhand.runs.run import Run

INTERRUPTED = "interrupted"
"""A run that a person ended."""


def unfinished(last: ControlReport | None, run: Run) -> str:
    """Why a task was not finished, by the operator's newest report."""
    if last is None:
        return "the operator never ran"
    if last.states == 0:
        return "no state of the robot ever arrived: nothing was driven"
    found = f"{last.target_index} of {last.target_count or len(run.scenario.targets)} targets reached"
    if last.held_by:
        return f"{found}; no progress: held by {last.held_by}"
    if last.stop_reason:
        return f"{found}; at the end: {last.stop_reason}"
    return f"{found}; held back by {last.binding!r}" if last.binding else found


def too_near(robot: RobotResult, d_min: float) -> str:
    """Which part came too near to which obstacle; empty where none did."""
    found = []
    if robot.min_clearance is not None and robot.min_clearance < d_min:
        found.append(
            f"the tool's safety sphere came to {robot.min_clearance * 1e3:.1f} mm from "
            f"{_obstacle(robot.nearest_obstacle)}, limit {d_min * 1e3:g} mm"
        )
    if robot.min_arm_clearance is not None and robot.min_arm_clearance <= 0:
        part = f"the arm's {robot.nearest_part}" if robot.nearest_part else "the arm"
        deep = f" ({-robot.min_arm_clearance * 1e3:.1f} mm deep)" if robot.min_arm_clearance < 0 else ""
        found.append(f"{part} touched {_obstacle(robot.nearest_to_arm)}{deep}")
    return "; ".join(found)


def _obstacle(name: str) -> str:
    return f"obstacle {name!r}" if name else "an obstacle"
