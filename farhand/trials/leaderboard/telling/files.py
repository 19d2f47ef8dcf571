"""The files that are made of a table's rows."""

from collections.abc import Callable, Sequence
from pathlib import Path

from rich.console import Console

from farhand.common.result_file import write_whole
from farhand.laboratory.campaigns.run_sweep import PARQUET, WITHOUT_PARQUET, has_parquet, write_columns
from farhand.laboratory.campaigns.run_table1 import keep
from farhand.laboratory.campaigns.store import TABLE, to_csv
from farhand.trials.leaderboard.plan.board import Board
from farhand.trials.leaderboard.plan.rows import Row
from farhand.trials.leaderboard.tasks.posing import Posed
from farhand.trials.leaderboard.telling.figures import draw_figures
from farhand.trials.leaderboard.telling.page import html
from farhand.trials.leaderboard.telling.tables import to_markdown

MARKDOWN, PAGE, FIGURES = "leaderboard.md", "index.html", "figures"
NEEDED = {MARKDOWN, PAGE, TABLE}
"""A table without these is none."""


def write_files(
    board: Board, posed: Sequence[Posed], found: Sequence[Row], out: Path, console: Console
) -> set[str]:
    """All files; what cannot be written is said, and costs nothing else. Returns the names of those that were."""
    columns = {name: [getattr(row, name) for row in found] for name in Row.__struct_fields__}
    commands = "\n    ".join(board.commands())
    writers: dict[str, Callable[[Path], object]] = {
        TABLE: lambda path: write_whole(path, to_csv(found, Row)),
        MARKDOWN: lambda path: write_whole(path, to_markdown(found, posed, commands)),
        PARQUET: lambda path: write_columns(columns, Row.UNITS, path),
        FIGURES: lambda path: draw_figures(found, path.parent),
        PAGE: lambda path: write_whole(path, html(board, posed, found, out)),
    }
    if not has_parquet():
        writers.pop(PARQUET)
        console.print(WITHOUT_PARQUET, style="yellow", highlight=False)
    return {name for name, write in writers.items() if keep(out / name, write, console)}
