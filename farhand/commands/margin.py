"""`farhand margin`: how good a margin is, without regard to a task."""

from pathlib import Path
from typing import Annotated

import typer

from farhand.commands.options import WorkersOption
from farhand.common.errors import FarhandError, InputError

margin_app = typer.Typer(help="Margin laws: how often they are wide enough.", no_args_is_help=True)


@margin_app.callback()
def margin() -> None:
    """Margin laws: how often they are wide enough."""


@margin_app.command()
def coverage(
    traces: Annotated[
        list[Path] | None,
        typer.Option("--trace", help="A recording of delays, or a folder of them; again for more."),
    ] = None,
    networks: Annotated[
        list[str] | None,
        typer.Option("--network", help="A SPEC or a named network; again for more."),
    ] = None,
    laws: Annotated[
        str, typer.Option(help="Margin laws with commas between them (default: all there are).")
    ] = "",
    seconds: Annotated[
        float, typer.Option(min=5.0, max=86_400.0, help="How long each law drives over each network, s.")
    ] = 120.0,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the network's draws.")] = 0,
    workers: WorkersOption = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, in SI units.")] = False,
) -> None:
    """How often the prediction's error and the true round trip stayed within what the margin reckoned with, and how
    wide it was: for every law, on every network. A point robot drives to and fro in virtual time, without a guard.
    """
    import msgspec
    from rich.progress import Progress

    from farhand.common.process.console import page
    from farhand.laboratory.campaigns.pools import LocalPool
    from farhand.laboratory.coverage.campaign import Drive, measure
    from farhand.laboratory.coverage.table import print_coverage
    from farhand.laboratory.coverage.traces import find_traces
    from farhand.operator_side.margins.registry import MARGINS

    named = [word.strip() for word in laws.split(",") if word.strip()] or list(MARGINS.names())
    for name in named:
        MARGINS.get(name, "--laws")
    recordings, left_out = find_traces(traces or [])
    _say_left_out(left_out)
    over = {each: each for each in networks or []} | recordings
    if not over:
        raise InputError("give --trace FILE or FOLDER, or --network SPEC")
    drives = [Drive(name, spec, law, seconds, seed) for name, spec in over.items() for law in named]
    console = page(stderr=True)
    columns = Progress.get_default_columns()
    # Into a file, a bar would leave an empty line and nothing else.
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("driving", total=len(drives))
        pool = None if workers == 1 else LocalPool(workers)
        rows = measure(drives, pool, lambda done: bar.update(task, completed=done))
    if as_json:
        typer.echo(msgspec.json.encode(rows).decode())
    else:
        print_coverage(rows, page())


def _say_left_out(errors: list[FarhandError]) -> None:
    """One line, however many files of a folder are no recordings: a folder may hold anything."""
    if len(errors) == 1:
        typer.echo(f"margin: left out: {errors[0]}", err=True)
    elif errors:
        typer.echo(f"margin: left out: {len(errors)} files, the first one: {errors[0]}", err=True)
