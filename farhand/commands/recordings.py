"""Commands that look at what was recorded: `report`, `runs`."""

from pathlib import Path
from typing import Annotated

import typer

from farhand.common.errors import InputError


def register(app: typer.Typer) -> None:
    """Add the commands to the command line."""
    app.command()(report)
    app.command()(runs)


def report(
    run: Annotated[
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
    if len(run) > 2:
        raise InputError(f"report: takes one run or two, not {len(run)}")
    from farhand.report.write import run_report

    raise typer.Exit(run_report(run, out, as_json))


def runs(
    folder: Annotated[Path, typer.Argument(help="Folder that holds runs.")] = Path("runs"),
    prune: Annotated[bool, typer.Option("--prune", help="Remove what the next three options say.")] = False,
    older_than: Annotated[
        float | None, typer.Option(min=0.0, metavar="DAYS", help="With --prune: runs that are older.")
    ] = None,
    keep: Annotated[
        int | None, typer.Option(min=0, metavar="NUMBER", help="With --prune: all but so many, the newest.")
    ] = None,
    max_size: Annotated[
        float | None,
        typer.Option(min=0.0, metavar="MB", help="With --prune: the oldest, until so much is left."),
    ] = None,
    yes: Annotated[bool, typer.Option("--yes", help="With --prune: do not ask.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the list as one line of JSON.")] = False,
) -> None:
    """What runs there are: when, scenario, network, result, length, size.

    With --prune the oldest go: their own files, and nothing else that lies in their folders; a folder that is no run
    or is being written to stays. Exit code 0: done. 1: something could not be removed. 2: bad input.
    """
    import sys

    from farhand.runs.shelf.pruning import Bounds
    from farhand.runs.shelf.run_table import run_list, run_prune

    if not prune:
        if older_than is not None or keep is not None or max_size is not None or yes:
            raise InputError("runs: --older-than, --keep, --max-size and --yes go with --prune")
        raise typer.Exit(run_list(folder, as_json))
    if not yes and (as_json or not sys.stdin.isatty()):
        raise InputError("--prune: nobody can be asked here; say --yes")
    bounds = Bounds(days=older_than, number=keep, size=None if max_size is None else max_size * 1e6)
    raise typer.Exit(run_prune(folder, bounds, None if yes else typer.confirm, as_json))
