"""The table as people and programs read it: terminal, Markdown, JSON."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from rich.table import Table

from farhand.laboratory.campaigns.jobs import Row
from farhand.laboratory.campaigns.statistics import Cell
from farhand.laboratory.campaigns.table1 import DELAYS, PaperCell, Table1, cells, paper_cell

HEADINGS = (
    "delay, each way",
    "margin",
    "success (95 % interval)",
    "paper, of 10",
    "least, median clearance (mm)",
    "time vs no margin",
    "interventions",
    "infeasible",
    "stops",
)
NOTES = (
    "Success: all targets reached and the true clearance never below 10 mm. Intervals: Clopper-Pearson, 95 %. "
    "Time: mean over the tasks of the duration relative to the same task and delay without margin. "
    "Interventions and infeasible solves: ticks, mean of a task. Stops: latched stops, sum.",
)

Cells = Mapping[tuple[str, str], Cell]


def table_rows(found: Cells) -> list[tuple[str, ...]]:
    """The table's text, a tuple a cell."""
    return [_texts(delay, margin, cell, paper_cell(delay, margin)) for (delay, margin), cell in found.items()]


def to_markdown(table: Table1, rows: Sequence[Row]) -> str:
    """The table as Markdown, with its settings and the rows that crashed."""
    lines = [
        "| " + " | ".join(HEADINGS) + " |",
        "|" + "---|" * len(HEADINGS),
        *("| " + " | ".join(texts) + " |" for texts in table_rows(cells(rows))),
        "",
        *NOTES,
        f"{len(table.indices)} tasks a cell, seed {table.seed}, robot `{table.robot}`"
        f"{', ' + str(sum(bool(r.error) for r in rows)) + ' crashed' if any(r.error for r in rows) else ''}.",
    ]
    return "\n".join(lines) + "\n"


def to_rich(rows: Sequence[Row]) -> Table:
    """The table for a terminal."""
    notes = " ".join(NOTES).replace("Interventions", "Acted (the filter intervened)")
    rich = Table(caption=notes, caption_justify="left", title_justify="left")
    for number, heading in enumerate(HEADINGS):
        shown = "acted" if heading == "interventions" else heading
        rich.add_column(shown, justify="left" if number < 2 else "right")
    previous = ""
    for texts in table_rows(cells(rows)):
        if previous and texts[0] != previous:
            rich.add_section()
        name, _, spec = texts[0].removesuffix("`)").partition(" (`")
        delay = name + spec.replace(f"{name}:", "\n")  # narrow: `gaussian` over `50,20`
        rich.add_row("" if texts[0] == previous else delay, *texts[1:])
        previous = texts[0]
    return rich


def to_json(table: Table1, rows: Sequence[Row], run: Mapping[str, Any]) -> dict[str, Any]:
    """Everything but the rows themselves, as plain values.

    Args:
        table: what was run.
        rows: all rows.
        run: how it ran: wall time, workers.
    """
    listed = []
    for (delay, margin), cell in cells(rows).items():
        paper = paper_cell(delay, margin)
        listed.append(
            {
                "delay": delay,
                "margin": margin,
                **asdict(cell),
                "paper": asdict(paper) if paper is not None else None,
            }
        )
    crashes = [{"key": row.key, "seed": row.seed, "error": row.error} for row in rows if row.error]
    return {"about": table.about(), "cells": listed, "crashes": crashes, "run": dict(run)}


def _texts(delay: str, margin: str, cell: Cell, paper: PaperCell | None) -> tuple[str, ...]:
    spec = DELAYS[delay]
    return (
        delay if spec == delay else f"{delay} (`{spec}`)",
        margin,
        f"{percent(cell.rate)} ({100 * cell.low:.1f}–{100 * cell.high:.1f})",
        "–" if paper is None else f"{percent(paper.rate)} ({100 * paper.low:.0f}–{100 * paper.high:.0f})",
        f"{millimetres(cell.min_clearance)}, {millimetres(cell.median_clearance)}",
        "–" if cell.relative_duration is None else f"{100 * (cell.relative_duration - 1):+.1f} %",
        f"{cell.interventions:.1f}",
        f"{cell.infeasible:.2f}",
        str(cell.stops),
    )


def percent(share: float | None) -> str:
    """`97.5 %`; a dash for nothing."""
    return "–" if share is None else f"{100 * share:.4g} %"


def millimetres(length: float | None) -> str:
    """A length in m as mm; a dash for nothing."""
    return "–" if length is None else f"{length * 1e3:.1f}"
