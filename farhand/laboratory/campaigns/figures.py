"""The figures of the table in the manner of the paper's: paths, clearance over time, box plots."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np

from farhand.common.geometry import Array
from farhand.laboratory.campaigns.jobs import Row
from farhand.laboratory.campaigns.table1 import DELAYS, Table1
from farhand.laboratory.simulation import simulate_run
from farhand.runs.figure import BLUE, GREEN, GREY, ORANGE, RED, STYLE, WIDTH, save
from farhand.runs.run import COMPUTING_TIME
from farhand.runs.scenario import Scenario
from farhand.runs.scene_drawing import draw_shapes


class Style(NamedTuple):
    """How a margin law is drawn, and what it is called."""

    colour: str
    line: str | tuple[int, tuple[int, ...]]
    name: str


STYLES = {
    "none": Style(RED, "--", "without margin"),
    "paper": Style(BLUE, "-", "paper's margin"),
    "adaptive": Style(ORANGE, "-.", "adaptive margin"),
}
OTHERS = ((GREEN, ":"), ("#CC79A7", (0, (5, 1))), ("#56B4E9", (0, (3, 1, 1, 1))), ("#000000", (0, (1, 1))))
"""Colours and lines of laws from outside, in the order of the table."""
PREFERRED = ("constant", "uniform", "gaussian", "none")


def style_of(margin: str, margins: Iterable[str]) -> Style:
    """The style of one of a table's margin laws; laws from outside take turns."""
    if margin in STYLES:
        return STYLES[margin]
    place = [name for name in margins if name not in STYLES].index(margin)
    colour, line = OTHERS[place % len(OTHERS)]
    return Style(colour, line, f"{margin} margin")


def draw_table1(table: Table1, rows: Sequence[Row], folder: Path) -> list[Path]:
    """Write `path`, `clearance` and `boxes`, each as PNG and PDF; returns the PNGs."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    good = [row for row in rows if not row.error]
    if not any(row.min_clearance is not None for row in good):
        return []
    delay, index = telling_task(table, good)
    runs = {margin: _path(table, delay, margin, index) for margin in table.margins}
    scenario = table.job(delay, table.margins[0], index).run.scenario
    written = []
    with plt.rc_context(STYLE):
        for name, figure in (
            ("path", _paths(plt, scenario, runs, delay, index)),
            ("clearance", _clearances(plt, scenario, runs, delay, index)),
            ("boxes", _boxes(plt, table, good)),
        ):
            png = folder / f"{name}.png"
            save(figure, png, dpi=200)
            save(figure, folder / f"{name}.pdf")
            plt.close(figure)
            written.append(png)
    return written


def telling_task(table: Table1, rows: Sequence[Row]) -> tuple[str, int]:
    """The delay and task to show: the first task that fails without margin and succeeds with the others."""
    by_key = {row.key: row for row in rows}
    delays = [name for name in PREFERRED if name in table.delays]
    for delay in delays:
        for index in table.indices:
            found = {m: by_key.get(f"{delay}/{m}/{index}") for m in table.margins}
            without = found.pop("none", None)
            if without is not None and not without.success and all(r and r.success for r in found.values()):
                return delay, index
    return delays[0], table.indices[0]


def _path(table: Table1, delay: str, margin: str, index: int) -> Array:
    """(n, 5): t, x, y, z, clearance, of one task run again."""
    run = table.job(delay, margin, index).run
    again = simulate_run(msgspec.structs.replace(run, computing_time=(COMPUTING_TIME,)))
    return np.asarray(again.trajectory, dtype=float).reshape(-1, 5)


def _paths(plt: Any, scenario: Scenario, runs: dict[str, Array], delay: str, index: int) -> Any:
    """The whole task, and the closest approach enlarged."""
    figure, (whole, near) = plt.subplots(1, 2, figsize=(WIDTH, 3.7), layout="constrained")
    worst = runs.get("none", next(iter(runs.values())))
    at = worst[int(np.argmin(worst[:, 4]))]
    for axes in (whole, near):
        _world(axes, scenario)
        for margin, path in runs.items():
            style = style_of(margin, runs)
            axes.plot(
                path[:, 1],
                path[:, 3],
                color=style.colour,
                ls=style.line,
                lw=1.2,
                label=style.name,
            )
        axes.set_aspect("equal", adjustable="box")
        axes.set_xlabel("$x$ (m)")
        axes.set_ylabel("$z$ (m)")
    whole.plot(scenario.start[0], scenario.start[2], "s", color="black", ms=4, label="start")
    for number, target in enumerate(scenario.targets, 1):
        whole.plot(target[0], target[2], "*", color="black", ms=7, label="targets" if number == 1 else None)
        whole.annotate(str(number), (target[0], target[2]), xytext=(4, 4), textcoords="offset points")
    whole.set_xlim(0.0, 8.1)
    whole.set_ylim(0.0, 8.1)
    half = 0.5
    near.set_xlim(at[1] - half, at[1] + half)
    near.set_ylim(at[3] - half, at[3] + half)
    near.set_title(f"where the path without margin is nearest: {at[4] * 1e3:.1f} mm", fontsize=8)
    whole.set_title(f"task {index}, delay {delay}", fontsize=8)
    handles, labels = whole.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False, handlelength=2.4)
    return figure


def _world(axes: Any, scenario: Scenario) -> None:
    """Obstacles; the band that the box's centre must not enter shaded, its edge dashed."""
    keep = scenario.robot.radius + scenario.controller.d_min
    rings: list[tuple[float, str, dict[str, Any]]] = [
        (keep, "", {"fc": RED, "alpha": 0.12, "lw": 0}),
        (keep, "limit of the box's centre", {"fill": False, "ec": RED, "ls": "--", "lw": 0.8}),
        (0.0, "obstacle", {"color": GREY, "lw": 0}),
    ]
    draw_shapes(axes, scenario.obstacles, (0, 2), rings)


def _clearances(plt: Any, scenario: Scenario, runs: dict[str, Array], delay: str, index: int) -> Any:
    figure, (whole, near) = plt.subplots(
        1, 2, figsize=(WIDTH, 2.5), layout="constrained", width_ratios=(1.6, 1.0)
    )
    d_min = scenario.controller.d_min * 1e3
    worst = runs.get("none", next(iter(runs.values())))
    at = float(worst[int(np.argmin(worst[:, 4])), 0])
    for axes, low in ((whole, -40.0), (near, min(0.0, worst[:, 4].min() * 1e3 - 5.0))):
        axes.axhspan(low, d_min, color=RED, alpha=0.15, lw=0)
        axes.axhline(d_min, color=RED, lw=0.8, ls=":", label=f"$d_{{min}}$ = {d_min:g} mm")
        for margin, path in runs.items():
            style = style_of(margin, runs)
            axes.plot(
                path[:, 0],
                path[:, 4] * 1e3,
                color=style.colour,
                ls=style.line,
                lw=1.1,
                label=style.name,
            )
        axes.set_ylim(bottom=low)
        axes.set_xlabel("time (s)")
    whole.set_ylabel("clearance (mm)")
    whole.set_ylim(-40.0, 900.0)
    whole.set_xlim(left=0.0)
    whole.set_title(f"task {index}, delay {delay}", fontsize=8)
    near.set_xlim(at - 2.0, at + 2.0)
    near.set_ylim(top=max(60.0, 4.0 * d_min))
    near.set_title("nearest approach without margin", fontsize=8)
    handles, labels = whole.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False, handlelength=2.4)
    return figure


def _boxes(plt: Any, table: Table1, rows: Sequence[Row]) -> Any:
    """Smallest clearance of every task, by delay and margin: points over boxes."""
    from matplotlib.patches import Patch

    figure, axes = plt.subplots(figsize=(WIDTH, 2.9), layout="constrained")
    width = 0.8 / len(table.margins)
    scatter = np.random.Generator(np.random.PCG64(0))
    tops = []
    for group, delay in enumerate(table.delays):
        for number, margin in enumerate(table.margins):
            values = np.array(
                [
                    row.min_clearance * 1e3
                    for row in rows
                    if row.labels["delay"] == delay
                    and row.labels["margin"] == margin
                    and row.min_clearance is not None
                ]
            )
            if not len(values):
                continue
            place = group + (number - (len(table.margins) - 1) / 2) * width
            style = style_of(margin, table.margins)
            colour = style.colour
            axes.boxplot(
                values,
                positions=[place],
                widths=width * 0.8,
                showfliers=False,
                patch_artist=True,
                boxprops={"facecolor": colour, "alpha": 0.3, "edgecolor": colour, "linestyle": style.line},
                medianprops={"color": "black", "lw": 1.2},
                whiskerprops={"color": colour},
                capprops={"color": colour},
            )
            spread = place + scatter.uniform(-0.25, 0.25, len(values)) * width
            axes.plot(spread, values, ".", color=colour, ms=3.0, alpha=0.7, mew=0, zorder=3)
            tops.append(float(np.quantile(values, 0.98)))
    d_min = 10.0
    low = min(row.min_clearance * 1e3 for row in rows if row.min_clearance is not None)
    if low > 1.0:  # the interesting end is the small one
        axes.set_yscale("log")
        ticks = (2, 5, 10, 20, 50, 100, 200, 500, 1000)
        axes.set_yticks(ticks, list(map(str, ticks)))
        axes.minorticks_off()
    bottom = min(7.0, low * 0.8) if low > 1.0 else low - 10.0
    axes.axhspan(bottom, d_min, color=RED, alpha=0.15, lw=0)
    axes.axhline(d_min, color=RED, lw=0.8, ls=":")
    axes.set_ylim(bottom, max(tops) * 1.15)
    axes.set_xticks(range(len(table.delays)), [_delay_name(delay) for delay in table.delays])
    axes.set_xlim(-0.5, len(table.delays) - 0.5)
    axes.set_ylabel("smallest clearance of a task (mm)")
    patches = [
        Patch(facecolor=style.colour, alpha=0.4, edgecolor=style.colour, ls=style.line, label=style.name)
        for style in (style_of(margin, table.margins) for margin in table.margins)
    ]
    axes.legend(handles=patches, frameon=False, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    return figure


def _delay_name(delay: str) -> str:
    spec = DELAYS[delay]
    if spec == "none":
        return "no delay"
    _, _, numbers = spec.partition(":")
    return f"{delay}\n{numbers.replace(',', ', ')} ms each way"
