"""How it stands, in MoveIt Servo's codes and in diagnostics, always with our reason in words."""

from collections.abc import Iterable, Mapping

from farhand.common.geometry import norm
from farhand.common.messages.report import ControlReport
from farhand.common.messages.state import RobotState
from farhand.runs.words.guard import guard_words

INVALID, NO_WARNING, SLOWED_FOR_COLLISION, HALTED_FOR_COLLISION, JOINT_BOUND = -1, 0, 4, 5, 6
OK, WARN, ERROR, STALE = range(4)
"""Levels of diagnostic_msgs/msg/DiagnosticStatus."""
LOST_AFTER = 1.0
"""Without news for so long nothing is known (s)."""
STANDS = 0.005
"""m/s: what is slower stands."""
_LATCHED = ("stopped", "estop")
Status = tuple[str, int, str, Mapping[str, float | int | str | None]]
"""Name, level, words, figures."""


def unknown(report: ControlReport | None, age: float) -> str:
    """Why nothing is known; empty: something is.

    Args:
        report: the operator's newest.
        age: since it came (s).
    """
    if report is None:
        return "waiting for the operator's program"
    if age > LOST_AFTER:
        return "nothing is heard of the operator's program"
    if report.safety is None or report.state_age + age > LOST_AFTER:
        return "no news from the robot"
    return ""


def servo_status(report: ControlReport | None, age: float, state: RobotState | None) -> tuple[int, str]:
    """Code and words of moveit_msgs/msg/ServoStatus. Farhand's solver goes through singularities: no code is of one."""
    lost = unknown(report, age)
    if lost or report is None:
        return INVALID, lost
    if report.safety in _LATCHED:
        return INVALID, f"{report.safety}: {report.safety_reason}{_aside(report, state)}"
    asks = norm(report.desired) > STANDS
    held = state.held_by if state is not None and isinstance(state.held_by, str) else ""
    if asks and held.startswith("joint"):
        return JOINT_BOUND, held
    if report.guard is not None:
        did = report.guard
        return (
            HALTED_FOR_COLLISION if did.done < STANDS else SLOWED_FOR_COLLISION,
            f"guard {guard_words(did)}",
        )
    if asks and report.intervening and report.binding:
        halted = norm(report.filtered) < STANDS
        words = f"{'halted' if halted else 'slowed'} for {report.binding}"
        words += f"; free to the {report.free_side}" if report.free_side else ""
        return HALTED_FOR_COLLISION if halted else SLOWED_FOR_COLLISION, words
    return NO_WARNING, report.stop_reason or (f"held by {report.held_by}" if report.held_by else "")


def _aside(report: ControlReport, state: RobotState | None) -> str:
    """What the robot's guard does, or may do, in a stop that silence brought."""
    if report.safety != "stopped" or state is None or state.evades is not True:
        return ""
    return (
        f"; guard {guard_words(report.guard)}"
        if report.guard is not None
        else "; its guard may still move it"
    )


def diagnostics(report: ControlReport | None, age: float, state: RobotState | None,
                refused: Mapping[str, int], steers: str) -> Iterable[Status]:  # fmt: skip
    """Link, loop and safety as the operator's program reports them, and what this bridge refused."""
    lost = unknown(report, age)
    if report is not None and age <= LOST_AFTER:
        yield "link", ERROR if lost else OK, lost or "connected", {
            "round trip (s)": report.rtt,
            "round trip, mean (s)": report.rtt_mean,
            "loss": report.loss,
            "state age (s)": report.state_age,
            "states (1/s)": report.state_rate,
        }  # fmt: skip
        yield "loop", OK, report.status, {
            "tick": report.tick,
            "late ticks": report.overruns,
            "solve time (s)": report.solve_time,
            "margin (m)": report.inflation,
            "prediction error (m)": report.prediction_error,
        }  # fmt: skip
        code, words = servo_status(report, age, state)
        level = ERROR if report.safety in _LATCHED else OK if code == NO_WARNING else WARN
        yield "safety", level, words or (report.safety or "unknown"), {
            "clearance (m)": report.clearance,
            "least clearance (m)": report.min_clearance,
            "stops": report.stops,
            "commands refused": report.refused_there,
            "held by": report.held_by,
        }  # fmt: skip
    else:
        for name in ("link", "loop", "safety"):
            yield name, STALE, lost, {}
    yield "ros2", WARN if refused else OK, steers, dict(refused)
