"""The figure of a run: the path among the obstacles; clearance and round trip over time."""

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from farhand.common.geometry import Array
from farhand.common.result_file import write_whole
from farhand.operator_side.result import Sample
from farhand.runs.scenario import Scenario
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

Trajectory = Sequence[Sequence[float]]
Series = Sequence[Sample]


def draw_run(
    scenario: Scenario, summary: RunSummary, trajectory: Trajectory, series: Series, folder: Path
) -> Path:
    """Write `run.png` and `run.pdf`; returns the PNG.

    Args:
        scenario: for obstacles, targets and limits.
        summary: for the title.
        trajectory: (t, x, y, z, clearance) of the robot, in s and m.
        series: (t, rtt, sigma, inflation, clearance) of the operator's ticks, in s and m.
        folder: where to write.
    """
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    path = np.asarray(trajectory, dtype=float).reshape(-1, 5)
    with plt.rc_context(STYLE):
        figure = plt.figure(figsize=(WIDTH, 3.1), layout="constrained")
        grid = figure.add_gridspec(2, 2, width_ratios=(1.15, 1.0))
        _draw_path(figure.add_subplot(grid[:, 0]), scenario, path, series)
        above = figure.add_subplot(grid[0, 1])
        _draw_clearance(above, summary, path)
        _draw_round_trip(figure.add_subplot(grid[1, 1], sharex=above), series)
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
    verdict = ("safe" if summary.safe else "NOT SAFE") + (
        ", finished" if summary.finished else ", NOT FINISHED"
    )
    return f"{summary.scenario} over {summary.network}, margin {summary.margin}: {verdict}, {least}"


def plane_of(scenario: Scenario, path: Array) -> tuple[int, int]:
    """The two axes that show most of the motion, the vertical one second where it is among them."""
    points = np.vstack([np.asarray(scenario.targets), np.asarray(scenario.start)[None], path[:, 1:4]])
    extent = np.ptp(points, axis=0)
    first, second = sorted(sorted(range(3), key=lambda k: -extent[k])[:2])
    return first, second


def _draw_path(axes: Any, scenario: Scenario, path: Array, series: Series) -> None:
    from matplotlib.patches import Circle

    a, b = plane_of(scenario, path)
    keep = scenario.robot.radius + scenario.controller.d_min
    inflation = max((s[3] for s in series), default=0.0)
    for index, obstacle in enumerate(scenario.obstacles):
        centre = (obstacle.position[a], obstacle.position[b])
        first = index == 0
        axes.add_patch(
            Circle(centre, obstacle.radius, color=GREY, alpha=0.75, lw=0, label="obstacle" if first else None)
        )
        ring = {"fill": False, "lw": 0.9, "ls": "--"}
        axes.add_patch(
            Circle(
                centre, obstacle.radius + keep, ec=RED, label="tool centre's limit" if first else None, **ring
            )
        )
        if inflation > 0:
            label = f"with largest margin, {inflation * 1e3:.0f} mm" if first else None
            axes.add_patch(
                Circle(
                    centre, obstacle.radius + keep + inflation, ec=ORANGE, label=label, **ring | {"ls": ":"}
                )
            )
    axes.plot(path[:, 1 + a], path[:, 1 + b], color=BLUE, lw=1.3, label="tool")
    axes.plot(scenario.start[a], scenario.start[b], "s", color=BLUE, ms=5, label="start")
    for number, target in enumerate(scenario.targets, 1):
        axes.plot(target[a], target[b], "*", color=GREEN, ms=9, label="targets" if number == 1 else None)
        axes.annotate(str(number), (target[a], target[b]), xytext=(4, 4), textcoords="offset points")
    axes.set_aspect("equal", adjustable="datalim")
    unseen = np.ptp(path[:, 1 + 3 - a - b]) if len(path) else 0.0
    if unseen > 0.005:  # the rings are outlines of spheres: the tool may pass in front of one
        note = f"seen along ${AXES[3 - a - b]}$, in which the tool moves {unseen * 1e3:.0f} mm"
        axes.text(0.02, 0.98, note, transform=axes.transAxes, va="top", fontsize=6.5, color=GREY)
    axes.autoscale_view()
    axes.set_xlabel(f"${AXES[a]}$ (m)")
    axes.set_ylabel(f"${AXES[b]}$ (m)")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=3, frameon=False, handlelength=1.6)


def _draw_clearance(axes: Any, summary: RunSummary, path: Array) -> None:
    if len(path) == 0 or summary.min_clearance is None:
        axes.text(0.5, 0.5, "no obstacle", ha="center", transform=axes.transAxes)
        return
    moved = np.linalg.norm(path[:, 1:4] - path[0, 1:4], axis=1) > 1e-3
    began = path[int(np.argmax(moved)), 0] if moved.any() else path[0, 0]
    axes.plot(path[:, 0] - began, path[:, 4] * 1e3, color=BLUE, lw=1.0)
    low = min(-10.0, summary.min_clearance * 1e3 - 15.0)
    axes.axhspan(low, summary.d_min * 1e3, color=RED, alpha=0.15, lw=0)
    axes.axhline(
        summary.d_min * 1e3, color=RED, lw=0.8, ls="--", label=f"$d_{{min}}$ = {summary.d_min * 1e3:g} mm"
    )
    axes.set_ylim(bottom=low)
    axes.set_xlim(left=0)
    axes.set_ylabel("clearance (mm)")
    axes.legend(frameon=False, loc="upper right")


def _draw_round_trip(axes: Any, series: Series) -> None:
    known = [(t, rtt * 1e3) for t, rtt, *_ in series if rtt is not None and t > 0]
    if known:
        t, rtt = zip(*known, strict=True)
        axes.plot(t, rtt, color=ORANGE, lw=0.9)
        axes.set_ylim(bottom=0)
    axes.set_xlabel("time since the first motion (s)")
    axes.set_ylabel("round trip (ms)")
