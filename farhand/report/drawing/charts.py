"""The charts of a run over time: clearance, margin, speed, network, timing."""

import numpy as np

from farhand.operator_side.sensing.state_loss import COUNTED, SETTLE
from farhand.report.drawing.svg import Chart, Level, Line
from farhand.report.reading.figures import lateness, limit_of, period_of
from farhand.report.reading.margin import additive, width_of
from farhand.report.reading.story import Story

MM, MS = 1e3, 1e3
SHOWN_CLEARANCE = 0.2
"""Higher values are cut off, so that what is near the limit can be seen (m)."""
GAP_TICKS = 2.5
AREAS = {"floor": 0, "delay": 0, "innovation": 1, "jitter": 1, "spread": 2, "lag": 3}
"""Colours of the parts that are known, the same in every run."""


def clearance(story: Story, marks: str) -> Chart:
    """Of tool and arm over their limit."""
    limit = limit_of(story)
    states, ticks = story.states, story.ticks
    lines = []
    if story.scene is None or story.had_obstacles:
        if limit is not None:
            keep = (limit + ticks["inflation"]) * MM
            lines.append(
                Line("limit and margin (what the filter keeps)", "keepline", ticks["t"], keep, _gap(story))
            )
        in_order = states["late"] == 0.0
        t, tool, arm = (states[name][in_order] for name in ("t", "clearance", "arm"))
        if np.isfinite(arm).any():
            lines.append(Line("arm, bare", "line1", t, arm * MM, 0.5))
        lines.append(Line("tool's sphere", "line0", t, tool * MM, 0.5))
    levels = [Level(f"limit, {limit * MM:g} mm", "limit", limit * MM)] if limit is not None else []
    top = max(SHOWN_CLEARANCE, 6.0 * (limit or 0.0)) * MM
    return Chart("mm", lines, levels, height=230.0, top=top, marks=marks, name="clearance over time")


def margin(story: Story, marks: str) -> Chart:
    """Its parts on top of one another, and the newest error of the prediction."""
    parts, largest = additive(story)
    t = story.ticks["t"]
    stack = [
        Line(_part_label(name, largest), f"area{AREAS.get(name, k % 5)}", t, values * MM)
        for k, (name, values) in enumerate(parts.items())
    ]
    error = np.where(story.ticks["seen"] > 0, story.ticks["error"], np.nan) * MM
    width = width_of(story) * MM
    lines = [
        Line("whole margin", "keepline", t, width, _gap(story)),
        Line("newest error of the prediction", "error", t, error, _gap(story)),
    ]
    return Chart("mm", lines, (), stack, marks=marks, name="margin and its parts over time")


def speed(story: Story, marks: str) -> Chart:
    """Asked of the tool, and sent to the robot."""
    ticks = story.ticks
    lines = [
        Line("asked", "asked", ticks["t"], ticks["asked"], _gap(story)),
        Line("done (sent to the robot)", "line0", ticks["t"], ticks["done"], _gap(story)),
    ]
    return Chart("m/s", lines, marks=marks, name="speed of the tool over time")


def turning(story: Story, marks: str) -> Chart | None:
    """The same of turning; None where nobody turned."""
    ticks = story.ticks
    if not (ticks["turn_asked"].any() or ticks["turn_done"].any()):
        return None
    lines = [
        Line("asked", "asked", ticks["t"], ticks["turn_asked"], _gap(story)),
        Line("done (sent to the robot)", "line0", ticks["t"], ticks["turn_done"], _gap(story)),
    ]
    return Chart("rad/s", lines, height=150.0, marks=marks, name="turning of the tool over time")


def round_trip(story: Story, marks: str) -> Chart:
    """Round trip and ages."""
    ticks = story.ticks
    lines = [
        Line("oldest command without an answer", "line1", ticks["t"], ticks["age"] * MS, _gap(story)),
        Line("since the newest state came", "line2", ticks["t"], ticks["state_age"] * MS, _gap(story)),
        Line("round trip with computing", "line0", ticks["t"], ticks["rtt"] * MS, _gap(story)),
    ]
    return Chart("ms", lines, marks=marks, name="round trip and ages over time")


def loss(story: Story, marks: str) -> Chart:
    """Of states, in the operator's window."""
    ticks = story.ticks
    lines = [
        Line(
            f"states lost in {COUNTED:g} s, up to {SETTLE:g} s ago",
            "line0",
            ticks["t"],
            ticks["loss"] * 100.0,
            _gap(story),
        )
    ]
    return Chart("%", lines, height=120.0, marks=marks, name="loss over time")


def timing(story: Story) -> Chart | None:
    """How late ticks were and how long the solver took; None in virtual time, which measures neither."""
    if story.info.clock == "virtual":
        return None
    at, late = lateness(story)
    lines = [Line("tick later than a period after the one before", "line1", at, late * MS)]
    if story.ticks["solve"].any():
        lines.append(Line("solver", "line0", story.ticks["t"], story.ticks["solve"] * MS, _gap(story)))
    return Chart("ms", lines, height=150.0, name="timing of the operator's loop")


def _part_label(name: str, largest: bool) -> str:
    return f"{name}, where it is the largest" if largest and name != "lag" else name


def _gap(story: Story) -> float:
    return GAP_TICKS * (period_of(story) or 1.0)


def common_range(charts: list[Chart]) -> tuple[float, float]:
    """One that holds all of some charts."""
    ranges = np.array([chart.range() for chart in charts])
    low, high = ranges[:, 0].min(), ranges[:, 1].max()
    return float(low), float(high)
