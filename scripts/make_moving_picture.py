"""Draws docs/figures/without-and-with.gif from two simulated runs: one task without and with Farhand's margin.

    .venv/bin/python scripts/make_moving_picture.py [FILE]

The network delays by 200 ms each way. The same seed gives the same runs.
"""

import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np

from farhand.common.geometry import Array
from farhand.laboratory.simulation import SimulationResult, simulate_run
from farhand.runs.run import Run
from farhand.runs.scenario import Scenario, load_scenario, replace_settings

mpl.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.animation import FuncAnimation, PillowWriter

NETWORK = "constant:200"
WITHOUT = {"margin.kind": "none", "operator.predictor": "none", "guard.on": False}
RATE, SPEED_UP, REST = 10.0, 3.0, 15
"""Pictures a second; how many times faster than it was; pictures of rest at the end."""
SEEN = [1, 3]
"""Columns of x and z in a trajectory."""
BLUE, RED, GREEN, GREY = "#0072B2", "#D55E00", "#009E73", "#666666"


def drive(scenario: Scenario) -> tuple[SimulationResult, Array]:
    """A run and its trajectory: (t, x, y, z, clearance), t from the first motion."""
    result = simulate_run(Run.over(scenario, NETWORK, seed=0))
    path = np.asarray(result.trajectory, dtype=float)
    moved = np.linalg.norm(path[:, 1:4] - path[0, 1:4], axis=1) > 1e-3
    path = path[max(0, int(np.argmax(moved)) - 1) :]
    path[:, 0] -= path[0, 0]
    return result, path


def draw(to: Path) -> None:
    """Drive both, and write the picture."""
    scenario = load_scenario("box-obstacle")
    runs = [
        ("no margin, no prediction", drive(replace_settings(scenario, WITHOUT))),
        ("Farhand's margin and prediction", drive(scenario)),
    ]
    figure, all_axes = plt.subplots(1, 2, figsize=(7.6, 4.0), dpi=90, layout="constrained")
    marks = []
    for axes, (title, (_, path)) in zip(all_axes, runs, strict=True):
        for obstacle in scenario.obstacles:
            centre = (obstacle.position[0], obstacle.position[2])
            axes.add_patch(plt.Circle(centre, obstacle.shape.bounding_radius, color=GREY, alpha=0.35, lw=0))
            keep = obstacle.shape.bounding_radius + scenario.controller.d_min + scenario.robot.radius
            axes.add_patch(plt.Circle(centre, keep, fill=False, ec=RED, ls="--", lw=1.0))
        for target in scenario.targets:
            axes.plot(target[0], target[2], "*", color=GREEN, ms=11)
        everything = np.vstack([each[1] for _, each in runs])[:, SEEN]
        low, high = everything.min(axis=0) - 0.2, everything.max(axis=0) + 0.2
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        axes.set_aspect("equal")
        axes.set_title(title, fontsize=10)
        axes.set_xticks([])
        axes.set_yticks([])
        (line,) = axes.plot([], [], color=BLUE, lw=1.5)
        body = plt.Circle(path[0, SEEN], scenario.robot.radius, color=BLUE, alpha=0.6, lw=0)
        axes.add_patch(body)
        text = axes.text(0.5, 0.02, "", transform=axes.transAxes, fontsize=10, ha="center")
        marks.append((path, line, body, text))
    figure.supxlabel(
        "200 ms each way; dashed: the limit of its middle; seen from the side", fontsize=9, color=GREY
    )
    longest = max(path[-1, 0] for path, *_ in marks)
    count = int(longest / SPEED_UP * RATE) + 1

    def show(number: int) -> None:
        now = min(number, count) * SPEED_UP / RATE
        for path, line, body, text in marks:
            end = max(1, int(np.searchsorted(path[:, 0], now, side="right")))
            line.set_data(path[:end, 1], path[:end, 3])
            body.center = path[end - 1, SEEN]
            least = path[:end, 4].min() * 1e3
            hit = least < 0.0
            body.set_color(RED if hit else BLUE)
            text.set_text(f"least clearance {least:.0f} mm" + (": it hits" if hit else ""))
            text.set_color(RED if hit else "black")

    FuncAnimation(figure, show, frames=count + REST).save(to, writer=PillowWriter(fps=int(RATE)))
    for title, (result, _) in runs:
        summary = result.summary
        least = "unknown" if summary.min_clearance is None else f"{summary.min_clearance * 1e3:.1f} mm"
        print(f"{title}: {least} least, {'safe' if summary.safe else 'not safe'}")
    print(f"{to}: {to.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    draw(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("docs/figures/without-and-with.gif"))
