"""`farhand benchmark safety` from beginning to end: pose, run, tell, write."""

import json
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import msgspec
from rich.console import Console

from farhand.common.errors import InputError
from farhand.common.process.console import page, whole
from farhand.laboratory.campaigns.campaign import Work
from farhand.laboratory.campaigns.pools import Pool
from farhand.laboratory.campaigns.run_table1 import Words, report_crashes, run_with_progress
from farhand.laboratory.campaigns.store import CAMPAIGN, Store
from farhand.trials.leaderboard import running
from farhand.trials.leaderboard.plan import rows
from farhand.trials.leaderboard.plan.board import Board, versions_in
from farhand.trials.leaderboard.plan.rows import Row
from farhand.trials.leaderboard.tasks import posing
from farhand.trials.leaderboard.tasks.posing import Posed
from farhand.trials.leaderboard.telling.cells import told_cells
from farhand.trials.leaderboard.telling.files import NEEDED, write_files
from farhand.trials.leaderboard.telling.tables import by_method, by_scene, redrawn

TASKS = "tasks"
CHUNK = 4


@dataclass(frozen=True)
class _Folder:
    """What the folder of a table holds.

    Attributes:
        out: the folder.
        tasks, store: its tasks and rows, of all commands.
    """

    out: Path
    tasks: Store[Posed]
    store: Store[Row]

    def everything(self, board: Board) -> tuple[Board, list[Posed], list[Row]]:
        """The board of all that is there, the tasks that were done and the rows, in its order.

        Of several versions of a method or a trace, the rows are those of the one that is there now, else of the last.
        """
        there = [*self.store.crashed.values(), *self.store.rows.values()]
        done = {(row.scene, row.index) for row in there}
        posed = [
            task for task in self.tasks.rows.values() if not task.error and (task.scene, task.index) in done
        ]
        over, by = dict[str, str](), dict[str, str]()
        for row in there:
            over[row.network], by[row.method] = versions_in(row.key)
        for known, now in zip((over, by), board.versions(), strict=True):
            known |= now
        found = [row for row in there if versions_in(row.key) == (over[row.network], by[row.method])]
        shown = board.showing(found)
        posed.sort(key=lambda task: (shown.scenes.index(task.scene), task.index))
        return shown, posed, shown.sorted_rows(found)


def run_board(board: Board, pool: Pool, out: Path, *, as_json: bool = False) -> int:
    """Run the campaign or what is missing of it.

    Returns:
        0; 1 when a run crashed, a task could not be posed, or a file could not be written.

    Raises:
        InputError: the folder is not one of such a campaign's, or nothing can be run.
    """
    console = page(stderr=as_json)
    board = replace(board, before=_commands_in(out))
    about = board.about()
    with closing(Store(out, about, Row)) as store, closing(Store(out / TASKS, about, Posed)) as tasks:
        folder = _Folder(out, tasks, store)
        try:
            posed, mine, run = _run(board, folder, pool, console)
        except KeyboardInterrupt:
            shown, posed, found = folder.everything(board)
            if found:
                write_files(shown, posed, found, out, console)
            raise
    shown, posed_ever, found = folder.everything(board)
    written = write_files(shown, posed_ever, found, out, console)
    _tell(mine, found, out, console)
    console.print(f"draws thrown away, unfit and undoable: {redrawn(posed_ever)}", highlight=False)
    unposed = _unposed(posed)
    if unposed:
        console.print(unposed, style="red", markup=False, highlight=False)
    if board.only is not None and len(mine) == 1:
        row = msgspec.json.format(msgspec.json.encode(mine[0])).decode()
        console.print(row, highlight=False, markup=False)
    console.print(f"results in {out}/: {', '.join(sorted(written))}", highlight=False)
    if as_json:
        print(json.dumps({"about": about, "run": run, "cells": told_cells(found)}), flush=True)
    return 1 if any(row.error for row in mine) or unposed or not written >= NEEDED else 0


def _run(
    board: Board, folder: _Folder, pool: Pool, console: Console
) -> tuple[list[Posed], list[Row], dict[str, Any]]:
    """The board's tasks and rows, in order, from the folder as far as they are there, and how long it took."""
    posed, _ = run_with_progress(
        board.pose_jobs(), folder.tasks, pool, console, Work(posing.pose_all, posing.lost), 1,
        Words("posing", "tasks", folder.out),
    )  # fmt: skip
    specs = board.specs(posed)
    if not specs:
        raise InputError(f"benchmark safety: nothing was run; {_unposed(posed)}")
    found, run = run_with_progress(
        specs, folder.store, pool, console, Work(running.run_all, rows.lost), CHUNK
    )
    return posed, found, run


def _tell(mine: Sequence[Row], found: Sequence[Row], out: Path, console: Console) -> None:
    """The tables of all that is there, and what crashed now."""
    for table in (by_scene(found), by_scene(found, "done"), by_method(found)):
        console.print(whole(table, console))
    before = len(found) - len(mine)
    if before:
        console.print(f"{before} of these {len(found)} runs are of other commands in {out}/", highlight=False)
    report_crashes(mine, console)


def _commands_in(out: Path) -> tuple[str, ...]:
    """Those that made what a folder holds."""
    try:
        found = json.loads((out / CAMPAIGN).read_text(encoding="utf-8"))
        return tuple(map(str, found["selection"]["commands"]))
    except (OSError, ValueError, KeyError, TypeError):
        return ()


def _unposed(posed: Sequence[Posed]) -> str:
    """Which tasks could not be posed, and why the first could not; empty: all could."""
    failed = [task for task in posed if task.error]
    if not failed:
        return ""
    names = ", ".join(task.key for task in failed)
    return f"tasks that could not be posed, and are in no cell: {names}: {failed[0].error}"
