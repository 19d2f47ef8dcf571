"""`farhand table1` from beginning to end: run, tables, figures, files."""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    Task,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from farhand.common.process.console import page, whole
from farhand.common.process.outputs import survive
from farhand.common.result_file import write_whole
from farhand.common.timing.clock import stopwatch_seconds
from farhand.laboratory.campaigns.campaign import CHUNK, J, Work, run_campaign
from farhand.laboratory.campaigns.jobs import Row
from farhand.laboratory.campaigns.pools import Pool
from farhand.laboratory.campaigns.store import TABLE, Kept, R, Store
from farhand.laboratory.campaigns.table1 import Table1
from farhand.laboratory.campaigns.table1_report import to_json, to_markdown, to_rich

JSON, MARKDOWN = "table1.json", "table1.md"
LONG, TOLD = 100, 50
"""A campaign of so many runs tells a log so often how far it is."""


@dataclass(frozen=True)
class Words:
    """Attributes:
    doing: what is done, in a word.
    things: what the jobs are.
    out: the folder with which a campaign that was interrupted goes on; None: that of the store.
    """

    doing: str = "running"
    things: str = "runs"
    out: Path | None = None


RUNNING = Words()


def run_table1(table: Table1, pool: Pool, out: Path, as_json: bool) -> int:
    """Run the campaign or what is missing of it; returns 0, or 1 when a task crashed."""
    console = page(stderr=as_json)
    store: Store[Row] = Store(out, table.about())
    jobs = table.jobs()
    rows, run = run_with_progress(jobs, store, pool, console)
    found = to_json(table, rows, run)
    keep(out / JSON, lambda path: write_whole(path, json.dumps(found, indent=1) + "\n"), console)
    keep(out / MARKDOWN, lambda path: write_whole(path, to_markdown(table, rows)), console)
    if table.only is None:
        from farhand.laboratory.campaigns.figures import draw_table1

        try:
            keep(out, lambda path: draw_table1(table, rows, path), console)
        except Exception as error:  # they run a task again, which may have crashed
            console.print(
                f"figures cannot be drawn: {type(error).__name__}: {error}", style="yellow", markup=False
            )
    console.print(whole(to_rich(rows), console))
    report_crashes(rows, console)
    console.print(f"results in {out}/: {JSON}, {MARKDOWN}, tasks.csv, figures", highlight=False)
    if as_json:
        print(json.dumps(found), flush=True)
    return 1 if any(row.error for row in rows) else 0


def keep(path: Path, write: Callable[[Path], object], console: Console) -> bool:
    """Write a file or folder of results; where the disk fails, say so, go on, and return False."""

    def written() -> bool:
        write(path)
        return True

    told = survive(
        str(path), written, lambda line: console.print(line, style="yellow", markup=False, highlight=False)
    )
    return bool(told)


def run_with_progress(
    jobs: list[J],
    store: Store[R],
    pool: Pool,
    console: Console,
    work: Work[J, R] | None = None,
    chunk: int = CHUNK,
    words: Words = RUNNING,
) -> tuple[list[R], dict[str, Any]]:
    """Rows in order and how long they took; `tasks.csv` is written whatever happens.

    Args:
        jobs, store, pool, work, chunk: see run_campaign.
        console: shows progress and the time left.
        words: what is said of it.
    """
    things, out = words.things, words.out or store.folder
    before = len(jobs) - len(store.missing(jobs))
    if before:
        console.print(f"going on: {before} of {len(jobs)} {things} are there already", highlight=False)
    began = stopwatch_seconds()
    bar = Progress(
        words.doing,
        BarColumn(),
        MofNCompleteColumn(),
        "elapsed",
        TimeElapsedColumn(),
        "left",
        TimeRemainingColumn(),
        console=console,
    )
    try:
        with bar:
            line = bar.add_task("", total=len(jobs), completed=before)

            def advance(row: R) -> None:
                if row.error:
                    bar.console.print(f"crashed: {row.key}, seed {row.seed}: {row.error}", highlight=False)
                bar.advance(line)
                if not console.is_terminal:
                    _tell_the_file(bar.tasks[0], before, words.doing, console)

            rows = run_campaign(jobs, store, pool, advance, chunk, work)
    except KeyboardInterrupt:
        there = len(jobs) - len(store.missing(jobs))
        console.print(
            f"interrupted: {there} of {len(jobs)} {things} are kept in {store.folder}; "
            f"the same with --out {out} goes on",
            markup=False,
            highlight=False,
        )
        raise
    finally:
        keep(store.folder / TABLE, lambda _: store.write_table(store.ordered(jobs)), console)
        store.close()
        if store.trouble:
            console.print(store.trouble, style="yellow", markup=False, highlight=False)
    wall = stopwatch_seconds() - began
    new = [row for row in rows[:] if row.duration is not None]
    run = {
        "workers": pool.workers,
        "runs": len(jobs),
        "runs_now": len(jobs) - before,
        "wall_time": wall,
        "virtual_time": sum(row.duration or 0.0 for row in new),
    }
    return rows, run


def _tell_the_file(task: Task, before: int, what: str, console: Console) -> None:
    """A line now and then where no bar can be drawn: into a log, of a campaign that takes long.

    Args:
        task: of the bar.
        before: how many of its runs were there already.
        what: is done, in a word.
        console: the log.
    """
    total, done = round(task.total or 0), round(task.completed)
    if total < LONG or done == total or done * TOLD // total == (done - 1) * TOLD // total:
        return
    elapsed = (task.elapsed or 0.0) / 60.0
    left = elapsed * (total - done) / (done - before)
    console.print(f"{what}: {done} of {total}, {elapsed:.1f} min elapsed, {left:.1f} left", highlight=False)


def report_crashes(rows: Sequence[Kept], console: Console) -> None:
    """Name the rows without a result and how to see one again."""
    crashes = [row for row in rows if row.error]
    for row in crashes[:10]:
        console.print(f"crashed: {row.key}, seed {row.seed}: {row.error}", style="red", highlight=False)
    if len(crashes) > 10:
        console.print(f"and {len(crashes) - 10} more, see tasks.csv", style="red")
