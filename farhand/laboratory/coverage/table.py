"""The table of a coverage, for people: fits a terminal of 80 columns."""

from collections.abc import Sequence
from itertools import groupby

from rich.console import Console
from rich.table import Table

from farhand.common.process.console import whole
from farhand.laboratory.coverage.campaign import CoverageRow
from farhand.laboratory.coverage.measures import Coverage

HEADINGS = (
    "commands applied /sent",
    "error within margin, %",
    "error, mm p95/most",
    "margin, mm mean/p95",
    "answered as reckoned, %",
    "round trip reckoned, ms",
    "answered after, ms mean/most",
)
NOTE = (
    "Error: of the prediction, of commands that were applied; the others were lost, refused as overtaken ones are, or "
    "replaced at once. Answered as reckoned: within the round trip that the law reckoned with. p95: 95 % are no "
    "larger. -: the law reckons with no round trip, or nothing came."
)


def print_coverage(rows: Sequence[CoverageRow], console: Console) -> None:
    """Print the rows, those of a network below its name, and what the headings mean."""
    table = Table(title="margins held against what became of each command", title_justify="left")
    table.add_column("network, law", overflow="fold")
    for heading in HEADINGS:
        table.add_column(heading, justify="right")
    for network, laws in groupby(rows, key=lambda row: row.network):
        table.add_row(network, style="bold")
        for row in laws:
            table.add_row(row.law, *_cells(row.coverage))
        table.add_section()
    console.print(whole(table, console))
    console.print(NOTE, style="dim", highlight=False)


def _cells(found: Coverage) -> list[str]:
    return [
        f"{found.applied}/{found.commands}",
        _percent(found.within),
        _pair(found.error_95, found.error_most),
        _pair(found.width_mean, found.width_95),
        _percent(found.answered_within),
        _thousandths(found.reckoned_mean),
        _pair(found.answered_mean, found.answered_most),
    ]


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:.1f}"


def _thousandths(value: float | None) -> str:
    return "-" if value is None else f"{1000 * value:.0f}"


def _pair(one: float | None, other: float | None) -> str:
    return "-" if one is None else f"{_thousandths(one)}/{_thousandths(other)}"
