"""The leaderboard as one HTML file that needs nothing else."""

import base64
import json
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any

from farhand.trials.leaderboard.board import Board
from farhand.trials.leaderboard.cells import Cell, cell_of
from farhand.trials.leaderboard.method import method_named
from farhand.trials.leaderboard.networks import NETWORKS
from farhand.trials.leaderboard.operators import OPERATORS
from farhand.trials.leaderboard.posing import Posed
from farhand.trials.leaderboard.rows import Row
from farhand.trials.leaderboard.scenes import SCENES
from farhand.trials.leaderboard.tables import redrawn

HERE = Path(__file__).parent
ALL = "*"
FIGURES = (
    ("trade", "What safety costs: runs that were not safe, over the time against the ideal operator"),
    ("clearance", "The smallest clearance of every run"),
)


def html(board: Board, posed: Sequence[Posed], rows: Sequence[Row], folder: Path) -> str:
    """The page; figures are taken from the folder as far as they are there."""
    style, script = ((HERE / name).read_text(encoding="utf-8") for name in ("page.css", "page.js"))
    data = json.dumps(_data(board, rows), separators=(",", ":")).replace("</", "<\\/")
    methods = "".join(_described(name, method_named(name)) for name in board.methods)
    scenes = "".join(_entry(name, SCENES[name].says) for name in board.scenes)
    operators = "".join(_entry(name, OPERATORS[name].says) for name in board.operators)
    networks = "".join(_entry(name, spec) for name, spec in board.networks.items() if name != spec)
    crashed = sum(bool(row.error) for row in rows)
    figures = "".join(_figure(folder / f"{name}.svg", caption) for name, caption in FIGURES)
    versions = ", ".join(f"{name} {value}" for name, value in sorted(board.about()["versions"].items()))
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,"><title>Farhand: safety leaderboard</title>
<style>
{style}</style></head>
<body>
<header><h1>Safety over bad networks</h1>
<p>The same tasks, networks and seeds for every method, in virtual time: {len(rows) - crashed} runs. A run is
<b>safe</b> if no part of the robot ever came nearer than 10 mm to anything; it is
<b>done</b> if it was safe and reached every target. A violation is <b>evadable</b> if one
velocity, from some instant in the 2 s before, kept or ended after a while, would have kept the robot clear; else it was
<b>run over</b> if it stood in a latched stop, in which it may not move. Intervals are exact, 95 % (Clopper and
Pearson). Choose a cell for its figures and for the command that repeats it.</p></header>
<main>
<div class="controls" id="controls"></div>
<div class="wide"><table id="board"></table></div>
<p class="legend" id="legend"></p>
<section id="detail" aria-live="polite"></section>
{f'<section class="figures">{figures}</section>' if figures else ""}
<section class="columns">
<div><h2>Methods</h2><dl>{methods}</dl></div>
<div><h2>Scenes</h2><dl>{scenes}</dl>
<p class="said">Draws thrown away before the first that fits and that the ideal operator can do (unfit and
undoable, for so many tasks): {escape(redrawn(posed))}.</p>
<h2>Operators</h2><dl>{operators}</dl></div>
<div><h2>Networks</h2><dl>{networks}</dl></div>
</section>
<section><h2>How it was made</h2><p><code>{escape(board.command())}</code></p>
<p class="said">{crashed} runs crashed. {escape(versions)}</p></section>
</main>
<script>const BOARD = {data};
{script}</script>
</body></html>
"""


def _data(board: Board, rows: Sequence[Row]) -> dict[str, Any]:
    grouped: dict[tuple[str, str, str, str], list[Row]] = {}
    for row in rows:
        for scene in (row.scene, ALL):
            for network in (row.network, ALL):
                grouped.setdefault((row.operator, row.method, scene, network), []).append(row)
    return {
        "operators": list(board.operators),
        "methods": list(board.methods),
        "says": {name: method_named(name).says for name in board.methods},
        "scenes": list(board.scenes),
        "networks": list(board.networks),
        "seed": board.seed,
        "tasks": board.tasks,
        "only": board.only,
        "subset": _subset(board),
        "cells": {"|".join(key): _figures(cell_of(found)) for key, found in grouped.items()},
    }


def _subset(board: Board) -> dict[str, Any]:
    """What the commands must name where a cell is over all of the board's, and the board has not all there are."""
    networks = None if tuple(board.networks) == tuple(NETWORKS) else list(board.networks)
    scenes = None if board.scenes == tuple(SCENES) else ",".join(board.scenes)
    return {"networks": networks, "scenes": scenes}


def _figures(cell: Cell) -> dict[str, Any]:
    """What the page shows of a cell, rounded as far as it is shown."""
    worst = cell.worst
    found = {
        "n": cell.runs,
        "crashed": cell.crashed,
        "done": _rounded(cell.success_rate, 5),
        "doneOf": cell.successes,
        "doneIn": [_rounded(cell.success_low, 4), _rounded(cell.success_high, 4)],
        "safe": _rounded(cell.safe_rate, 5),
        "safeOf": cell.safe,
        "safeIn": [_rounded(cell.safe_low, 4), _rounded(cell.safe_high, 4)],
        "violations": cell.violations,
        "evadable": cell.evadable,
        "runOver": cell.run_over,
        "couldEvade": cell.could_evade,
        "evades": _rounded(cell.could_evade / cell.runs, 5) if cell.runs else None,
        "depth": _rounded(cell.depth, 4),
        "seconds": _rounded(cell.seconds, 2),
        "least": _rounded(cell.least, 4),
        "median": _rounded(cell.median, 4),
        "tool": _rounded(cell.least_tool, 4),
        "time": _rounded(cell.time, 3),
        "path": _rounded(cell.path, 3),
        "filtered": _rounded(cell.filtered, 3),
        "strength": _rounded(cell.filtered_strength, 3),
        "guarded": _rounded(cell.guarded, 3),
        "guardStrength": _rounded(cell.guard_strength, 3),
        "stops": _rounded(cell.stops, 2),
        "smoothness": _rounded(cell.smoothness, 2),
        "worst": None if worst is None else [worst.network, worst.scene, worst.index],
    }
    return {key: value for key, value in found.items() if value is not None and value != 0}


def _rounded(value: float | None, digits: int) -> float | None:
    return None if value is None else round(value, digits)


def _described(name: str, method: Any) -> str:
    source = f' <span class="said">{escape(method.source)}</span>' if method.source else ""
    return f"<dt>{escape(name)}</dt><dd>{escape(method.says)}.{source}</dd>"


def _entry(name: str, says: str) -> str:
    return f"<dt>{escape(name)}</dt><dd>{escape(says)}</dd>"


def _figure(path: Path, caption: str) -> str:
    if not path.exists():
        return ""
    text = base64.b64encode(path.read_bytes()).decode()
    return (
        f'<figure><img alt="{escape(caption)}" src="data:image/svg+xml;base64,{text}">'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )
