"""Commands that look at what was recorded: `report`, `runs`."""

from pathlib import Path
from typing import Annotated

import typer

from farhand.common.errors import InputError


def register(app: typer.Typer) -> None:
    """Add the commands to the command line."""
    app.command()(report)


def report(
    runs: Annotated[
        list[Path], typer.Argument(metavar="RUN [RUN2]", help="A run's folder, or its run.mcap; or two.")
    ],
    out: Annotated[
        Path | None,
        typer.Option("--out", help="HTML file to write (default: report.html in the run's folder)."),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print all figures as one line of JSON; no page without --out.")
    ] = False,
) -> None:
    """One HTML page of a recorded run that opens anywhere, or of two runs side by side.

    Exit code 0: written, whatever it tells of the run. 2: bad input.
    """
    if len(runs) > 2:
        raise InputError(f"report: takes one run or two, not {len(runs)}")
    from farhand.report.write import run_report

    raise typer.Exit(run_report(runs, out, as_json))
