"""`farhand margin`: how good a margin is, without regard to a task."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from farhand.commands.options import WorkersOption
from farhand.common.errors import FarhandError, InputError

if TYPE_CHECKING:
    from farhand.laboratory.coverage.campaign import CoverageRow

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
    from farhand.operator_side.margins.registry import MARGINS

    named = [word.strip() for word in laws.split(",") if word.strip()] or list(MARGINS.names())
    for name in named:
        MARGINS.get(name, "--laws")
    over = {each: each for each in networks or []} | _traces(traces or [])
    if not over:
        raise InputError("give --trace FILE or FOLDER, or --network SPEC")
    drives = [Drive(name, spec, law, seconds, seed) for name, spec in over.items() for law in named]
    with Progress(*Progress.get_default_columns(), console=page(stderr=True), transient=True) as bar:
        task = bar.add_task("driving", total=len(drives))
        pool = None if workers == 1 else LocalPool(workers)
        rows = measure(drives, pool, lambda done: bar.update(task, completed=done))
    if as_json:
        typer.echo(msgspec.json.encode(rows).decode())
    else:
        _print(rows)


def _traces(paths: list[Path]) -> dict[str, str]:
    """SPEC of each recording, by its name; a folder stands for those of its files that can be read."""
    from farhand.netem.recordings.trace import load_trace

    found: dict[str, str] = {}
    for path in paths:
        inside = sorted(each for each in path.rglob("*") if each.is_file()) if path.is_dir() else [path]
        readable = 0
        for file in inside:
            try:
                load_trace(file)
            except FarhandError as error:
                if not path.is_dir():
                    raise
                typer.echo(f"margin: left out: {error}", err=True)
                continue
            readable += 1
            found[str(file.relative_to(path)) if path.is_dir() else file.name] = f'trace:"{file}"'
        if not readable:
            raise InputError(f"--trace {path}: no file in it can be read as a recording of delays")
    return found


def _print(rows: "list[CoverageRow]") -> None:
    from rich.table import Table

    from farhand.common.process.console import page, whole

    table = Table(title="margins held against what became of each command", title_justify="left")
    for heading in ("network", "law"):
        table.add_column(heading)
    for heading in ("within", "error, mm", "margin, mm", "answered", "reckoned", "took, ms"):
        table.add_column(heading, justify="right")
    for row in rows:
        found = row.coverage
        table.add_row(
            row.network,
            row.law,
            _percent(found.within),
            _pair(found.error_95, found.error_most),
            _pair(found.width_mean, found.width_95),
            _percent(found.answered_within),
            _thousandths(found.reckoned_mean),
            _pair(found.answered_mean, found.answered_most),
        )
    console = page()
    console.print(whole(table, console))
    console.print(
        "within: predictions that were off by no more than the margin. error: 95 % of them, the most. "
        "margin: mean, 95 %. answered: within the round trip that the law reckoned with, in ms beside it. "
        "took: mean, the most.",
        style="dim",
        highlight=False,
    )


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:.1f} %"


def _thousandths(value: float | None) -> str:
    return "-" if value is None else f"{1000 * value:.0f}"


def _pair(one: float | None, other: float | None) -> str:
    return "-" if one is None else f"{_thousandths(one)}/{_thousandths(other)}"
