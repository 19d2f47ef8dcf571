"""Where tables and lines for people go: a terminal as wide as it is, or a file whose lines do not wrap."""

import os
import sys
from itertools import zip_longest

from rich import box
from rich.console import Console, RenderableType
from rich.measure import Measurement
from rich.table import Column, Table

FILE_WIDTH = 4096
FOLDED = 12
"""A column whose words may be broken anywhere is at least this wide."""


def page(*, stderr: bool = False, highlight: bool = True, emoji: bool = True) -> Console:
    """A console on stdout, or on stderr; `COLUMNS` says how wide, as everywhere.

    What is printed there is text as it stands: `[words]` in brackets are no markup, whosever they are.
    """
    file = sys.stderr if stderr else sys.stdout
    free = not file.isatty() and not os.environ.get("COLUMNS", "").isdigit()
    width = FILE_WIDTH if free else None
    return Console(file=file, width=width, markup=False, highlight=highlight, emoji=emoji)


def whole(table: Table, console: Console) -> RenderableType:
    """The table in a form that the console shows without cutting a word.

    As it is where it fits; else with narrower columns, then without frame; where even the longest words do not
    fit beside one another, each row as a list of its own.
    """
    if table.columns:
        for frame in (True, False):
            if not frame:
                table.box, table.show_edge, table.pad_edge = box.SIMPLE_HEAD, False, False
                table.padding = 0
            if _fit(table, console):
                return table
        return _as_lists(table)
    return table


def _fit(table: Table, console: Console) -> bool:
    """Give every column a width for the longest of its words, and what is left to those that need least."""
    measured = [_measure(column, console) for column in table.columns]
    _, right, _, left = table.padding
    count = len(measured)
    sides = 2 if table.show_edge and table.box else 0
    padding = (left + right) * count - (0 if table.pad_edge else left + right)
    room = console.width - sides - padding - (count - 1 if table.box else 0)
    widths = [least for least, _ in measured]
    spare = room - sum(widths)
    if spare < 0:
        return False
    wants = [most - least for least, most in measured]
    for number in sorted(range(count), key=wants.__getitem__):  # who needs little gets all of it
        given = min(wants[number], spare)
        widths[number] += given
        spare -= given
    for column, width in zip(table.columns, widths, strict=True):
        column.width = width
    return True


def _measure(column: Column, console: Console) -> tuple[int, int]:
    """The widths of a column's longest word and of its longest line."""
    found = [
        Measurement.get(console, console.options.update(width=FILE_WIDTH), cell) for cell in _texts(column)
    ]
    most = max(each.maximum for each in found)
    least = most if column.no_wrap else max(each.minimum for each in found)
    return (min(least, FOLDED) if column.overflow == "fold" else least), most


def _texts(column: Column) -> list[RenderableType]:
    return [column.header, *column.cells]


def _as_lists(table: Table) -> Table:
    """A line a cell, behind its heading; an empty line between rows."""
    listed = Table.grid(padding=(0, 1))
    listed.title, listed.caption = table.title, table.caption
    listed.title_justify, listed.caption_justify = table.title_justify, table.caption_justify
    listed.add_column(style="bold", overflow="fold")
    listed.add_column(overflow="fold")
    headings = [column.header for column in table.columns]
    for number, row in enumerate(zip_longest(*(column.cells for column in table.columns), fillvalue="")):
        if number:
            listed.add_row()
        for heading, cell in zip(headings, row, strict=True):
            listed.add_row(heading, cell)
    return listed
