"""The tables of docs/leaderboard.md, made of the rows in docs/leaderboard/.

In the text each stands between `<!-- table: NAME -->` and `<!-- end -->`.
"""

import re
from collections.abc import Callable, Sequence

import msgspec
import pyarrow.parquet as pq

from farhand.trials.leaderboard.plan.rows import Row
from farhand.trials.leaderboard.tasks.scenes import SCENES
from farhand.trials.leaderboard.telling.cells import Cell, cells_by
from farhand.trials.leaderboard.telling.tables import bound, millimetres, percent
from tests.installed import ROOT

PAGE = ROOT / "docs" / "leaderboard.md"
ROWS = ROOT / "docs" / "leaderboard"
MARK = re.compile(r"(<!-- table: (\S+) -->\n)(.*?)(<!-- end -->)", re.DOTALL)


def rows_of(name: str) -> list[Row]:
    """The published rows of a table, as they were written by `farhand benchmark safety`."""
    table = pq.read_table(ROWS / f"{name}.parquet")
    return [msgspec.convert(row, Row) for row in table.to_pylist()]


def operators() -> list[str]:
    """A line a method: how the three operators fare with it, over everything."""
    rows = rows_of("all")
    cells = cells_by(rows, lambda row: (row.method, row.operator))
    lines = head("method", "tester: safe % (95 %)", "done %", "time", "deepest, mm", "person: safe % (95 %)", "done %",
                 "time", "deepest, mm", "hostile: safe % (95 %)", "deepest, mm")  # fmt: skip
    for method in dict.fromkeys(row.method for row in rows):
        tester, person, hostile = (cells[method, name] for name in ("tester", "person", "hostile"))
        figures = [_safe(tester), percent(tester.success_rate), _time(tester), _deepest(tester)]
        figures += [_safe(person), percent(person.success_rate), _time(person), _deepest(person)]
        lines.append(line(f"`{method}`", *figures, _safe(hostile), _deepest(hostile)))
    return lines


def scenes() -> list[str]:
    """A line a method, a column a scene: safe runs of all three operators, and where that is not all, could evade."""

    def text(cell: Cell) -> str:
        return str(cell.safe) + (f" ({cell.could_evade})" if cell.could_evade else "")

    return _grid(rows_of("all"), lambda row: row.scene, text)


def networks() -> list[str]:
    """A line a network, a column a method: safe runs in percent, all of the sphere's scenes and all operators."""
    rows = [row for row in rows_of("all") if SCENES[row.scene].robot == "sphere"]
    methods = list(dict.fromkeys(row.method for row in rows))
    lines = head("network", *(f"`{name}`" for name in methods))
    cells = cells_by(rows, lambda row: (row.network, row.method))
    for network in dict.fromkeys(row.network for row in rows):
        lines.append(line(f"`{network}`", *(percent(cells[network, name].safe_rate) for name in methods)))
    return lines


def both() -> list[str]:
    """A line a scene: both layers among movers, over all networks."""
    return _claims(rows_of("both"))


TABLES: dict[str, Callable[[], list[str]]] = {
    "operators": operators,
    "scenes": scenes,
    "networks": networks,
    "both": both,
}


def renewed(text: str) -> str:
    """The page with every table as the rows have it."""
    return MARK.sub(lambda found: f"{found[1]}{chr(10).join(TABLES[found[2]]())}\n{found[4]}", text)


def head(*names: str) -> list[str]:
    """The first two lines of a table."""
    return [line(*names), "|" + "---|" * len(names)]


def line(*figures: object) -> str:
    """A line of it."""
    return "| " + " | ".join(map(str, figures)) + " |"


def _claims(rows: Sequence[Row]) -> list[str]:
    lines = head("scene", "tasks × networks", "safe", "at most unsafe, %", "run over, no way out", "evadable", "done",
                 "time", "least, mm")  # fmt: skip
    for scene, cell in cells_by(rows, lambda row: row.scene).items():
        own = [row for row in rows if row.scene == scene]
        tasks, over = len({row.index for row in own}), len({row.network for row in own})
        other = sum(not row.safe and not row.evadable for row in own)
        figures = (
            f"{tasks} × {over}",
            f"{cell.safe} of {cell.runs}",
            f"{100 * (1 - cell.safe_low):.2f}",
            other,
        )
        lines.append(
            line(f"`{scene}`", *figures, cell.could_evade, cell.successes, _time(cell), _tenths(cell.least))
        )
    return lines


def _grid(rows: Sequence[Row], column: Callable[[Row], str], text: Callable[[Cell], str]) -> list[str]:
    columns = list(dict.fromkeys(map(column, rows)))
    cells = cells_by(rows, lambda row: (row.method, column(row)))
    counts = {name: {cells[key].runs for key in cells if key[1] == name} for name in columns}
    lines = head("method", *(f"{name} ({'/'.join(map(str, sorted(counts[name])))})" for name in columns))
    for method in dict.fromkeys(row.method for row in rows):
        lines.append(line(f"`{method}`", *(text(cells[method, name]) for name in columns)))
    return lines


def _safe(cell: Cell) -> str:
    return f"{percent(cell.safe_rate)} ({bound(cell.safe_low)}–{bound(cell.safe_high)})"


def _time(cell: Cell) -> str:
    return "–" if cell.time is None else f"{cell.time:.2f}"


def _deepest(cell: Cell) -> str:
    return millimetres(cell.depth) if cell.violations else "–"


def _tenths(length: float | None) -> str:
    return "–" if length is None else f"{1e3 * length:.1f}".replace("-", "−")
