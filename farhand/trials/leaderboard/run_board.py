"""`farhand benchmark safety` from beginning to end: pose, run, tables, figures, page."""

import json
from pathlib import Path
from typing import Any

import msgspec
from rich.console import Console

from farhand.common.errors import InputError
from farhand.common.process.console import page, whole
from farhand.common.result_file import write_whole
from farhand.laboratory.campaigns.campaign import Work
from farhand.laboratory.campaigns.pools import Pool
from farhand.laboratory.campaigns.run_sweep import PARQUET, WITHOUT_PARQUET, has_parquet, write_columns
from farhand.laboratory.campaigns.run_table1 import keep, report_crashes, run_with_progress
from farhand.laboratory.campaigns.store import TABLE, Store
from farhand.trials.leaderboard import posing, rows, running
from farhand.trials.leaderboard.board import Board
from farhand.trials.leaderboard.figures import draw_figures
from farhand.trials.leaderboard.page import html
from farhand.trials.leaderboard.posing import Posed
from farhand.trials.leaderboard.rows import Row
from farhand.trials.leaderboard.tables import by_method, by_scene, redrawn, to_markdown

TASKS, MARKDOWN, PAGE = "tasks", "leaderboard.md", "index.html"
CHUNK = 4


def run_board(board: Board, pool: Pool, out: Path, *, as_json: bool = False) -> int:
    """Run the campaign or what is missing of it; returns 0, or 1 when a run crashed."""
    console = page(stderr=as_json)
    posed, found, run = _rows(board, pool, out, console)
    if not found:
        raise InputError("benchmark safety: no task could be posed; nothing was run")
    _write(board, posed, found, out, console)
    for table in (by_scene(found), by_scene(found, "done"), by_method(found)):
        console.print(whole(table, console))
    console.print(f"draws thrown away, unfit and undoable: {redrawn(posed)}", highlight=False)
    report_crashes(found, console)
    if board.only is not None and len(found) == 1:
        console.print(
            msgspec.json.format(msgspec.json.encode(found[0])).decode(), highlight=False, markup=False
        )
    console.print(f"results in {out}/: {PAGE}, {MARKDOWN}, {TABLE}, figures", highlight=False)
    if as_json:
        print(json.dumps({"about": board.about(), "run": run}), flush=True)
    return 1 if any(row.error for row in found) else 0


def _rows(
    board: Board, pool: Pool, out: Path, console: Console
) -> tuple[list[Posed], list[Row], dict[str, Any]]:
    """The tasks and the rows, in order, from the folder as far as they are there."""
    about = board.about()
    store = Store(out, about, Row)
    tasks = Store(out / TASKS, about, Posed)
    posing_work = Work(posing.pose_all, posing.lost)
    posed, _ = run_with_progress(board.pose_jobs(), tasks, pool, console, posing_work, 1, "posing")
    found, run = run_with_progress(
        board.specs(posed), store, pool, console, Work(running.run_all, rows.lost), CHUNK
    )
    return posed, found, run


def _write(board: Board, posed: list[Posed], found: list[Row], out: Path, console: Console) -> None:
    """All files; what cannot be written is said, and costs nothing else."""
    keep(out / MARKDOWN, lambda path: write_whole(path, to_markdown(found, posed, board.command())), console)
    if has_parquet():
        columns = {name: [getattr(row, name) for row in found] for name in Row.__struct_fields__}
        keep(out / PARQUET, lambda path: write_columns(columns, Row.UNITS, path), console)
    else:
        console.print(WITHOUT_PARQUET, style="yellow", highlight=False)
    keep(out, lambda folder: draw_figures(found, folder), console)
    keep(out / PAGE, lambda path: write_whole(path, html(board, posed, found, out)), console)
