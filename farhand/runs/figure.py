"""The figure of a run: the path among the obstacles; clearance and round trip over time."""

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from farhand.common.geometry import Array
from farhand.common.result_file import write_whole
from farhand.common.shapes.obstacle import moved
from farhand.operator_side.accounts.result import Sample, Span
from farhand.runs.scenario import Scenario
from farhand.runs.scene_drawing import draw_shapes, draw_ways, seen_inside
from farhand.runs.summary import RunSummary

WIDTH = 7.16  # inches: two columns of an IEEE page
BLUE, ORANGE, GREEN, RED, GREY = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#666666"
STYLE: dict[Any, Any] = {
    "font.family": "serif",
    "font.size": 8,
    "axes.labelsize": 8,
    "legend.fontsize": 7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "pdf.fonttype": 42,
    "ps.fonttype": 42,
}
AXES = "xyz"

GUARD_BAR = 0.05  # of the axes' height
SILENCE = {"color": GREY, "alpha": 0.25, "lw": 0}
ABOVE: dict[str, Any] = {
    "loc": "lower right",
    "bbox_to_anchor": (1.0, 1.0),
    "borderaxespad": 0.0,
    "frameon": False,
    "ncols": 3,
}
"""A legend over its axes, where no curve is."""
STOP = {"color": RED, "lw": 0.9, "ls": "-."}

Trajectory = Sequence[Sequence[float]]
Series = Sequence[Sample]


def draw_run(
    scenario: Scenario,
    summary: RunSummary,
    trajectory: Trajectory,
    series: Series,
    folder: Path,
    silences: Sequence[Span] = (),
    guarding: Sequence[Span] = (),
) -> Path:
    """Write `run.png` and `run.pdf`; returns the PNG.

    Args:
        scenario: for obstacles, targets and limits.
        summary: for the title, the stops and what was lost.
        trajectory: (t, x, y, z, clearance) of the robot, in s and m.
        series: (t, rtt, sigma, inflation, clearance) of the operator's ticks, in s and m.
        folder: where to write.
        silences: (from, to) of times without an answer of the robot, s since the first motion command.
        guarding: (from, to) of times in which the guard on the robot acted.
    """
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    path = np.asarray(trajectory, dtype=float).reshape(-1, 5)
    began = summary.began or 0.0
    with plt.rc_context(STYLE):
        figure = plt.figure(figsize=(WIDTH, 3.5), layout="constrained")
        grid = figure.add_gridspec(2, 2, width_ratios=(1.15, 1.0))
        _draw_path(figure.add_subplot(grid[:, 0]), scenario, summary, path, series)
        above = figure.add_subplot(grid[0, 1])
        _draw_clearance(above, summary, path, began)
        _mark_guard(above, guarding)
        below = figure.add_subplot(grid[1, 1], sharex=above)
        _draw_round_trip(below, series, silences)
        _mark_interruptions(above, below, summary, silences)
        above.tick_params(labelbottom=False)
        figure.suptitle(_title(summary), fontsize=8, x=0.01, ha="left")
        png = folder / "run.png"
        save(figure, png, dpi=200)
        save(figure, folder / "run.pdf")
        plt.close(figure)
    return png


def save(figure: Any, path: Path, **how: Any) -> None:
    """Write a figure, whole or not at all; raises OSError."""
    drawn = io.BytesIO()
    figure.savefig(drawn, format=path.suffix[1:], **how)
    write_whole(path, drawn.getvalue())


def _title(summary: RunSummary) -> str:
    least = (
        "no obstacle"
        if summary.min_clearance is None
        else f"least clearance {summary.min_clearance * 1e3:.1f} mm"
    )
    verdict = "safe" if summary.safe else "NOTHING WAS DRIVEN" if summary.driven is False else "NOT SAFE"
    if not summary.end_known:
        verdict += ", finished or not: unknown"
    else:
        verdict += ", finished" if summary.finished else ", NOT FINISHED"
    return f"{summary.scenario} over {summary.network}, margin {summary.margin}: {verdict}, {least}"


def plane_of(scenario: Scenario, path: Array) -> tuple[int, int]:
    """The two axes that show most of the motion, the vertical one second where it is among them."""
    points = np.vstack([np.asarray(scenario.targets), np.asarray(scenario.start)[None], path[:, 1:4]])
    extent = np.ptp(points, axis=0)
    first, second = sorted(sorted(range(3), key=lambda k: -extent[k])[:2])
    return first, second


def passing(scenario: Scenario, path: Array, plane: tuple[int, int]) -> Array:
    """(n,) whether the tool is drawn inside the outline of a limit that it is in front of or behind.

    The rings are outlines of solids: in the plane of the drawing the tool may be inside one, in space it is not.
    """
    keep = scenario.robot.radius + scenario.controller.d_min
    found = np.zeros(len(path), dtype=bool)
    for obstacle in scenario.obstacles:
        places = path[:, 1:4]
        if obstacle.moves:  # the tool as seen by somebody who rides on it
            way = [moved(obstacle, t).position for t in (path[:, 0] - path[:1, 0]).tolist()]
            places = places - np.array(way).reshape(-1, 3) + np.array(obstacle.position)
        found |= seen_inside(obstacle, plane, places, keep)
    return found


def margin_when_nearest(series: Series) -> float:
    """The inflation in force when the clearance was least (m): what the path at the obstacle shows.

    The largest of a run may come from a moment far away from any obstacle, and its ring would swallow the path.
    """
    known = [(sample[4], sample[3]) for sample in series if sample[4] is not None]
    return min(known)[1] if known else 0.0


def _draw_path(axes: Any, scenario: Scenario, summary: RunSummary, path: Array, series: Series) -> None:
    a, b = plane_of(scenario, path)
    _draw_obstacles(axes, scenario, (a, b), path, margin_when_nearest(series))
    robot = summary.counts.robot
    if robot is not None and robot.scene_changes:
        note = "obstacles are the scenario's; the scene was changed while it ran"
        axes.text(0.02, 0.97, note, transform=axes.transAxes, fontsize=6.5, color=RED)
    hidden = passing(scenario, path, (a, b))
    x, y = path[:, 1 + a], path[:, 1 + b]
    axes.plot(x, np.where(hidden, np.nan, y), color=BLUE, lw=1.3, label="tool")
    if hidden.any():
        label = f"tool in front of it or behind (${AXES[3 - a - b]}$)"
        axes.plot(x, np.where(hidden, y, np.nan), color=BLUE, lw=0.7, ls=(0, (1, 1)), label=label)
    too_near = path[:, 4] < summary.d_min
    if too_near.any():
        axes.plot(x, np.where(too_near, y, np.nan), color=RED, lw=3.0, label="too near")
        worst = int(np.argmin(path[:, 4]))
        axes.plot(x[worst], y[worst], "o", ms=11, mfc="none", mec=RED, mew=1.2)
    axes.plot(scenario.start[a], scenario.start[b], "s", mfc="none", mec=BLUE, ms=11, mew=1.2, label="start")
    numbers: dict[tuple[float, float], list[str]] = {}
    for number, target in enumerate(scenario.targets, 1):
        numbers.setdefault((target[a], target[b]), []).append(str(number))
    for place, known in numbers.items():
        axes.plot(*place, "*", color=GREEN, ms=9, label="targets" if known[0] == "1" else None)
        axes.annotate(", ".join(known), place, xytext=(7, 5), textcoords="offset points")
    _mark_stops(axes, summary, path, (a, b))
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.07)
    axes.autoscale_view()
    axes.set_xlabel(f"${AXES[a]}$ (m)")
    axes.set_ylabel(f"${AXES[b]}$ (m)")
    axes.figure.legend(
        *axes.get_legend_handles_labels(), loc="outside lower left", ncols=4, frameon=False, handlelength=1.6
    )


def _draw_obstacles(
    axes: Any, scenario: Scenario, plane: tuple[int, int], path: Array, inflation: float
) -> None:
    """All obstacles: those that move where they were when the clearance was least, and their way."""
    keep = scenario.robot.radius + scenario.controller.d_min
    moving = any(o.moves for o in scenario.obstacles)
    rings: list[tuple[float, str, dict[str, Any]]] = [
        (
            0.0,
            "obstacle where it was when nearest" if moving else "obstacle",
            {"color": GREY, "alpha": 0.75, "lw": 0},
        ),
        (keep, "tool centre's limit", {"fill": False, "lw": 0.9, "ls": "--", "ec": RED}),
    ]
    if inflation > 0:
        label = f"with the margin when nearest, {inflation * 1e3:.0f} mm"
        rings.append((keep + inflation, label, {"fill": False, "lw": 0.9, "ls": ":", "ec": ORANGE}))
    since = float(path[int(path[:, 4].argmin()), 0] - path[0, 0]) if len(path) else 0.0
    hidden = draw_shapes(axes, [moved(o, since) for o in scenario.obstacles], plane, rings)
    draw_ways(axes, scenario.obstacles, plane, float(path[-1, 0] - path[0, 0]) if len(path) else 0.0)
    if hidden:
        note = f"not drawn, as not seen from the side: {', '.join(hidden)}"
        axes.text(0.02, 0.01, note, transform=axes.transAxes, fontsize=6.5, color=GREY)


def _mark_stops(axes: Any, summary: RunSummary, path: Array, plane: tuple[int, int]) -> None:
    """A cross where the tool was when the robot stopped."""
    if len(path) == 0:
        return
    began = summary.began or 0.0
    stops = [t + began for t, mode, _ in summary.interruptions if mode in ("stopped", "estop")]
    for number, t in enumerate(stops):
        row = path[min(len(path) - 1, int(np.searchsorted(path[:, 0], t)))]
        label = "stop" if number == 0 else None
        axes.plot(row[1 + plane[0]], row[1 + plane[1]], "x", color=RED, ms=7, mew=1.5, label=label)


def _draw_clearance(axes: Any, summary: RunSummary, path: Array, began: float) -> None:
    if len(path) == 0 or summary.min_clearance is None:
        axes.text(0.5, 0.5, "no obstacle", ha="center", transform=axes.transAxes)
        return
    t, clearance = path[:, 0] - began, path[:, 4] * 1e3
    d_min, least = summary.d_min * 1e3, summary.min_clearance * 1e3
    axes.plot(t, clearance, color=BLUE, lw=1.0)
    low = min(-10.0, least - 15.0)
    axes.axhspan(low, d_min, color=RED, alpha=0.15, lw=0)
    axes.axhline(d_min, color=RED, lw=0.8, ls="--", label=f"$d_{{min}}$ = {d_min:g} mm")
    axes.set_ylim(bottom=low)
    axes.set_xlim(left=0)
    axes.set_ylabel("clearance (mm)")
    if least < d_min:
        worst = int(np.argmin(clearance))
        axes.plot(t, np.where(clearance < d_min, clearance, np.nan), color=RED, lw=2.5)
        axes.plot(t[worst], clearance[worst], "o", ms=8, mfc="none", mec=RED, mew=1.2)
        axes.annotate(
            f"{d_min - least:.1f} mm too near",
            (t[worst], clearance[worst]),
            xytext=(0, 22),
            textcoords="offset points",
            ha="left" if t[worst] < 0.5 * t[-1] else "right",
            color=RED,
            bbox={"fc": "white", "ec": "none", "alpha": 0.8, "pad": 1.0},  # the curve may pass behind it
            arrowprops={"arrowstyle": "->", "color": RED, "lw": 0.8},
        )
    axes.legend(**ABOVE)


def _mark_guard(axes: Any, guarding: Sequence[Span]) -> None:
    """A bar along the bottom of the clearance while the guard acted; a legend of its own entry."""
    for number, (begin, end) in enumerate(guarding):
        label = "guard" if number == 0 else None
        axes.axvspan(max(0.0, begin), max(0.05, end), ymax=GUARD_BAR, color=GREEN, lw=0, label=label)
    if guarding:
        axes.legend(**ABOVE)


def _draw_round_trip(axes: Any, series: Series, silences: Sequence[Span]) -> None:
    """What was measured; the line is broken where nothing was."""
    known = [(t, rtt * 1e3) for t, rtt, *_ in series if rtt is not None and t > 0]
    if known:
        t, rtt = np.array(known).T
        for begin, end in silences:
            rtt = np.where((t > begin) & (t < end), np.nan, rtt)
        axes.plot(t, rtt, color=ORANGE, lw=0.9)
        axes.set_ylim(bottom=0)
    axes.set_xlabel("time since the first motion command (s)")
    axes.set_ylabel("round trip (ms)")


def _mark_interruptions(above: Any, below: Any, summary: RunSummary, silences: Sequence[Span]) -> None:
    """Times without an answer as grey bands, stops as lines, in both; what was lost as a note."""
    for axes in (above, below):
        right = axes.get_xlim()[1]
        for number, (begin, end) in enumerate(silences):
            label = "no answer" if number == 0 and axes is below else None
            axes.axvspan(max(0.0, begin), max(0.0, end), label=label, **SILENCE)
        stops = [t for t, mode, _ in summary.interruptions if mode in ("stopped", "estop")]
        for number, t in enumerate(stops):
            axes.axvline(t, label="stop" if number == 0 and axes is below else None, **STOP)
        axes.set_xlim(0.0, right)
    netem = summary.counts.netem
    if netem is not None:
        up, down = (sum(way.dropped.values()) for way in (netem.uplink, netem.downlink))
        if up or down:
            note = f"lost: {up} up, {down} down"
            below.text(0.0, 1.03, note, transform=below.transAxes, va="bottom", fontsize=6.5, color=GREY)
    if silences or stops:  # a hold has no mark of its own
        below.legend(**ABOVE)
