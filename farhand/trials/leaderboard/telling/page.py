"""The leaderboard as one HTML file that needs nothing else."""

import base64
import json
import re
from collections import Counter
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any

from farhand.common.errors import InputError
from farhand.trials.leaderboard.methods.method import method_named
from farhand.trials.leaderboard.plan.board import Board
from farhand.trials.leaderboard.plan.networks import NETWORKS
from farhand.trials.leaderboard.plan.operators import OPERATORS
from farhand.trials.leaderboard.plan.rows import Row
from farhand.trials.leaderboard.tasks.posing import Posed
from farhand.trials.leaderboard.tasks.scenes import SCENES
from farhand.trials.leaderboard.telling.cells import Cell, cell_of
from farhand.trials.leaderboard.telling.tables import INTERVALS, redrawn

HERE = Path(__file__).parent
ALL = "*"
FIGURES = (
    ("trade", "What safety costs: runs that were not safe, and the time over the ideal operator's"),
    ("clearance", "The smallest clearance of every run"),
)
COMMONEST, LONGEST = 3, 110
"""So many reasons of a cell are shown, of so many characters."""
SIGNED = ("least", "median", "tool", "smoothness")
"""Figures of a cell that may be missing: these are 0 only where the page says so, all others where it says nothing."""
WORDS = (
    ("safe", "no part of the robot ever came nearer than 10 mm to anything."),
    ("done", "safe, and every target reached; of the hostile operator, safe."),
    (
        "evadable",
        "of a violation: one velocity, from some instant in the 2 s before, kept or ended after a while, would have "
        "kept the robot clear.",
    ),
    ("run over", "of the others: the robot stood in a latched stop, in which it may not move."),
    ("crashed", "a run that crashed, or in which the method raised, counts as neither safe nor done."),
    (
        "the ideal operator",
        "the same tester, without any delay, with Farhand's guard or both layers (at least one of them brings it "
        "safely through). Times and ways are over the quickest of these, with side-steps or without.",
    ),
    ("intervals", INTERVALS),
)


def html(board: Board, posed: Sequence[Posed], rows: Sequence[Row], folder: Path) -> str:
    """The page; figures are taken from the folder as far as they are there."""
    style, script = ((HERE / name).read_text(encoding="utf-8") for name in ("page.css", "page.js"))
    data = json.dumps(_data(board, rows), separators=(",", ":")).replace("<", "\\u003c")
    methods = "".join(_described(name, *_said(name)) for name in board.methods)
    words = "".join(f"<div>{_entry(name, says)}</div>" for name, says in WORDS)
    scenes = "".join(_entry(name, SCENES[name].says if name in SCENES else "") for name in board.scenes)
    operators = "".join(
        _entry(name, OPERATORS[name].says if name in OPERATORS else "") for name in board.operators
    )
    networks = "".join(_entry(name, spec) for name, spec in board.networks.items() if name != spec)
    commands = "".join(f"<p><code>{escape(command)}</code></p>" for command in board.commands())
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
<p>The same tasks, networks and seeds for every method, in virtual time: {len(rows)} runs. Choose a cell for its
figures and for the command that repeats it.</p>
<details id="words" open><summary>What the words mean</summary><dl>{words}</dl></details></header>
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
<section><h2>How it was made</h2>{commands}
<p class="said">{crashed} of {len(rows)} runs crashed. {escape(versions)}</p></section>
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
    texts: dict[str, int] = {}
    cells = {
        "|".join(key): _figures(cell_of(found)) | _causes(found, texts) | _made(board, key, len(found))
        for key, found in grouped.items()
    }
    return {
        "operators": list(board.operators),
        "methods": list(board.methods),
        "says": {name: _said(name)[0] for name in board.methods},
        "scenes": list(board.scenes),
        "networks": list(board.networks),
        "seed": board.seed,
        "tasks": board.tasks,
        "only": board.only,
        "subset": _subset(board),
        "texts": list(texts),
        "cells": cells,
    }


def _made(board: Board, key: tuple[str, str, str, str], runs: int) -> dict[str, int]:
    """How many runs the command of a cell makes, where they are others beside its own: not all of a folder is even."""
    operator, _, scene, network = key
    over = len(board.networks) if network == ALL else 1
    made = over * sum(
        len(board.tasks_of(name, operator)) for name in (board.scenes if scene == ALL else (scene,))
    )
    return {} if made == runs else {"made": made}


def _causes(rows: Sequence[Row], texts: dict[str, int]) -> dict[str, Any]:
    """The commonest reasons why runs were not done, and why they crashed, each as [number of its text, how often].

    Args:
        rows: of a cell.
        texts: all of the page by number, for many cells have the same ones; new ones are added.
    """
    found = {
        "why": Counter(_in_short(_reason(row)) for row in rows if not row.error and not row.success),
        "error": Counter(_in_short(row.error) for row in rows if row.error),
    }
    return {
        name: [[texts.setdefault(text, len(texts)), count] for text, count in counted.most_common(COMMONEST)]
        for name, counted in found.items()
        if counted
    }


def _reason(row: Row) -> str:
    """Why a run was not done. The time limit differs from task to task, so that it is left out."""
    if row.why:
        return re.sub(r"^not finished within [\d.]+ s", "not finished in time", row.why)
    return "something came too near" if not row.safe else "not finished"


def _in_short(text: str) -> str:
    """One line, at most LONGEST characters of it."""
    line = " ".join(text.split())
    return line if len(line) <= LONGEST else line[: LONGEST - 1].rstrip() + "…"


def _subset(board: Board) -> dict[str, Any]:
    """What the commands must name where a cell is over all of the board's, and the board has not all there are."""
    networks = None if tuple(board.networks) == tuple(NETWORKS) else list(board.networks)
    scenes = None if board.scenes == tuple(SCENES) else ",".join(board.scenes)
    return {"networks": networks, "scenes": scenes}


def _figures(cell: Cell) -> dict[str, Any]:
    """What the page shows of a cell, rounded as far as it is shown; rates it works out from the counts itself."""
    worst = cell.worst
    found = {
        "n": cell.runs,
        "crashed": cell.crashed,
        "doneOf": cell.successes,
        "doneIn": [_share(cell.success_low), _share(cell.success_high)],
        "safeOf": cell.safe,
        "safeIn": [_share(cell.safe_low), _share(cell.safe_high)],
        "violations": cell.violations,
        "evadable": cell.evadable,
        "runOver": cell.run_over,
        "couldEvade": cell.could_evade,
        "depth": _rounded(cell.depth, 4),
        "seconds": _rounded(cell.seconds, 2),
        "least": _rounded(cell.least, 4),
        "median": _rounded(cell.median, 4),
        "tool": _rounded(cell.least_tool, 4),
        "time": _rounded(cell.time, 3),
        "path": _rounded(cell.path, 3),
        "filtered": _share(cell.filtered),
        "strength": _share(cell.filtered_strength),
        "guarded": _share(cell.guarded),
        "guardStrength": _rounded(cell.guard_strength, 3),
        "stops": _rounded(cell.stops, 2),
        "smoothness": _rounded(cell.smoothness, 2),
        "worst": None if worst is None else [worst.network, worst.scene, worst.index],
    }
    known = {key: value for key, value in found.items() if value is not None}
    return {key: value for key, value in known.items() if value != 0 or key in SIGNED}


def _rounded(value: float | None, digits: int) -> float | None:
    return None if value is None else round(value, digits)


def _share(value: float) -> float:
    """Rounded, but what is not all or nothing stays so."""
    return min(max(round(value, 6), 1e-6), 1.0 - 1e-6) if 0.0 < value < 1.0 else round(value, 6)


def _said(name: str) -> tuple[str, str]:
    """What a method says of itself, and its source; a stranger's class may be gone by now, or say no text."""
    try:
        method = method_named(name)
    except InputError:
        return "", ""
    says, source = (text if isinstance(text, str) else "" for text in (method.says, method.source))
    return says, source


def _described(name: str, says: str, source: str) -> str:
    said = f"{escape(says)}." if says else ""
    named = f' <span class="said">{escape(source)}</span>' if source else ""
    return f"<dt>{escape(name)}</dt><dd>{said}{named}</dd>"


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
