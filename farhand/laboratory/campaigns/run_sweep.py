"""`farhand sweep` from beginning to end: run, one table as CSV and Parquet, a summary a grid point."""

import importlib.util
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.table import Table

from farhand.common.process.console import page, whole
from farhand.common.result_file import write_whole
from farhand.laboratory.campaigns.jobs import UNITS, Row
from farhand.laboratory.campaigns.pools import Pool
from farhand.laboratory.campaigns.run_table1 import keep, report_crashes, run_with_progress
from farhand.laboratory.campaigns.statistics import Cell, summarise_cell
from farhand.laboratory.campaigns.store import FIELDS, TABLE, Store
from farhand.laboratory.campaigns.sweep import Sweep
from farhand.laboratory.campaigns.table1_report import millimetres, percent

JSON, PARQUET = "sweep.json", "tasks.parquet"
WITHOUT_PARQUET = f"no {PARQUET}: pyarrow is not installed (pip install 'farhand[parquet]')"


def run_sweep(sweep: Sweep, pool: Pool, out: Path, as_json: bool) -> int:
    """Run the sweep or what is missing of it; returns 0, or 1 when a run crashed."""
    console = page(stderr=as_json)
    store: Store[Row] = Store(out, sweep.about())
    rows, run = run_with_progress(sweep.jobs, store, pool, console)
    written = [JSON, TABLE]
    if has_parquet():
        keep(out / PARQUET, lambda path: write_parquet(rows, path), console)
        written.append(PARQUET)
    else:
        console.print(WITHOUT_PARQUET, style="yellow", markup=False, highlight=False)
    points = summarise_points(rows)
    listed = [{"point": labels, **asdict(cell)} for labels, cell in points]
    found = {"about": sweep.about(), "points": listed, "run": run}
    keep(out / JSON, lambda path: write_whole(path, json.dumps(found, indent=1) + "\n"), console)
    console.print(whole(_table(points), console))
    report_crashes(rows, console)
    console.print(f"results in {out}/: {', '.join(written)}", highlight=False)
    if as_json:
        print(json.dumps(found), flush=True)
    return 1 if any(row.error for row in rows) else 0


def summarise_points(rows: Sequence[Row]) -> list[tuple[dict[str, Any], Cell]]:
    """A cell for each point of the grid, in order."""
    grouped: dict[str, list[Row]] = {}
    for row in rows:
        grouped.setdefault(json.dumps(row.labels), []).append(row)
    return [(found[0].labels, summarise_cell(found)) for found in grouped.values()]


def has_parquet() -> bool:
    """Whether the package that writes Parquet is installed."""
    return importlib.util.find_spec("pyarrow") is not None


def write_parquet(rows: Sequence[Row], path: Path) -> None:
    """The rows as Parquet; units are metadata of the columns."""
    columns: dict[str, list[Any]] = {}
    for name in rows[0].labels if rows else ():
        columns[name] = _uniform([row.labels[name] for row in rows])
    for name in FIELDS:
        columns[name] = [getattr(row, name) for row in rows]
    write_columns(columns, UNITS, path)


def write_columns(columns: Mapping[str, list[Any]], units: Mapping[str, str], path: Path) -> None:
    """Columns by name as Parquet; units are their metadata."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    arrays = [pa.array(values) for values in columns.values()]
    fields = [
        pa.field(name, array.type, metadata={"unit": units[name]} if name in units else None)
        for name, array in zip(columns, arrays, strict=True)
    ]
    made = pa.BufferOutputStream()
    pq.write_table(pa.table(arrays, schema=pa.schema(fields)), made)
    write_whole(path, made.getvalue().to_pybytes())


def _uniform(values: list[Any]) -> list[Any]:
    """One type for a column: numbers as floats, what is mixed or nested as JSON text."""
    kinds = {type(value) for value in values}
    if len(kinds) == 1 and kinds <= {int, float, str, bool}:
        return values
    if kinds <= {int, float}:
        return [float(value) for value in values]
    return [value if isinstance(value, str) else json.dumps(value) for value in values]


def _table(points: list[tuple[dict[str, Any], Cell]]) -> Table:
    table = Table()
    for name in points[0][0] if points else ():
        table.add_column(name)
    for heading in ("success (95 % interval)", "least, median clearance (mm)", "duration (s)", "stops"):
        table.add_column(heading, justify="right")
    for labels, cell in points:
        table.add_row(
            *map(str, labels.values()),
            f"{percent(cell.rate)} ({100 * cell.low:.1f}–{100 * cell.high:.1f})",
            f"{millimetres(cell.min_clearance)}, {millimetres(cell.median_clearance)}",
            "–" if cell.median_duration is None else f"{cell.median_duration:.1f}",
            str(cell.stops),
        )
    return table
