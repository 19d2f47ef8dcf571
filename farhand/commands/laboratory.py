"""The laboratory's commands: `table1`, `sweep`, `replay`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from farhand.commands.options import (
    JsonOption,
    MarginOption,
    PredictorOption,
    SetOption,
    SolverOption,
    WorkersOption,
    parse_setting,
)
from farhand.common.errors import InputError
from farhand.common.timing.clock import local_timestamp
from farhand.operator_side.margins.registry import MARGINS

if TYPE_CHECKING:
    from farhand.laboratory.campaigns.pools import Pool

SchedulerOption = Annotated[
    str,
    typer.Option(help="Run on a Dask cluster instead: address of its scheduler, such as tcp://host:8786."),
]
OutOption = Annotated[
    Path | None,
    typer.Option(
        "--out", help="Folder for the results; a campaign in it goes on (default: runs/<time>-...)."
    ),
]
ComputingOption = Annotated[
    str,
    typer.Option(help="Modelled computing time of a tick: ms, or a recorded run or text file to draw from."),
]


def register(app: typer.Typer) -> None:
    """Add the commands to the command line."""
    app.command()(table1)
    app.command()(sweep)
    app.command()(replay)


def table1(
    tasks: Annotated[int, typer.Option(min=1, max=1_000_000, help="Tasks for each cell.")] = 200,
    seed: Annotated[int, typer.Option(min=0, help="Seed of tasks and networks.")] = 1,
    delays: Annotated[str, typer.Option(help="Some of none,gaussian,constant,uniform.")] = (
        "none,gaussian,constant,uniform"
    ),
    margins: Annotated[
        str, typer.Option(help=f"Some of {', '.join(MARGINS.names())}.")
    ] = "none,paper,adaptive",
    robot: Annotated[
        str,
        typer.Option(
            metavar="point | box", help="Model of the box: first-order lag, which is fast, or PyBullet."
        ),
    ] = "point",
    task: Annotated[int | None, typer.Option(min=0, help="Run this one task alone.")] = None,
    computing_time: ComputingOption = "20",
    workers: WorkersOption = 0,
    scheduler: SchedulerOption = "",
    out: OutOption = None,
    as_json: JsonOption = False,
) -> None:
    """The paper's Table I with many tasks: success rates with exact intervals, in virtual time.

    Exit code 0: done. 1: a task crashed. 2: bad input. A campaign that was stopped goes on with the same
    --out.
    """
    from farhand.laboratory.campaigns.computing_time import read_computing_time
    from farhand.laboratory.campaigns.run_table1 import run_table1
    from farhand.laboratory.campaigns.table1 import DELAYS, Table1, chosen

    if robot not in ("point", "box"):
        raise InputError(f"--robot {robot!r}: must be point or box")
    table = Table1(
        tasks=tasks,
        seed=seed,
        delays=chosen("--delays", delays, tuple(DELAYS)),
        margins=chosen("--margins", margins, MARGINS.names()),
        robot="box" if robot == "box" else "point",
        only=task,
        computing_time=read_computing_time(computing_time),
    )
    folder = out if out is not None else Path("runs") / f"{local_timestamp()}-table1"
    raise typer.Exit(run_table1(table, _pool(workers, scheduler), folder, as_json))


def sweep(
    file: Annotated[Path, typer.Argument(help="TOML file: scenario, network, seeds and a grid of values.")],
    workers: WorkersOption = 0,
    scheduler: SchedulerOption = "",
    out: OutOption = None,
    as_json: JsonOption = False,
) -> None:
    """Vary any setting of a scenario or a network over a grid and seeds; one table as CSV and Parquet.

    Exit code 0: done. 1: a run crashed. 2: bad input. A sweep that was stopped goes on with the same --out.
    """
    from farhand.laboratory.campaigns.run_sweep import run_sweep
    from farhand.laboratory.campaigns.sweep import Sweep

    read = Sweep(file)
    folder = out if out is not None else Path("runs") / f"{local_timestamp()}-{read.file.name}"
    raise typer.Exit(run_sweep(read, _pool(workers, scheduler), folder, as_json))


def replay(
    run: Annotated[Path, typer.Argument(help="A run's folder, or its run.mcap.")],
    margin: MarginOption = None,
    predictor: PredictorOption = None,
    solver: SolverOption = None,
    settings: SetOption = None,
    out: Annotated[Path | None, typer.Option("--out", help="Write a line a tick to this CSV file.")] = None,
    as_json: JsonOption = False,
) -> None:
    """Feed a recorded run through the controller again: the decisions must be identical to the byte.

    With --margin, --predictor, --solver or --set: what another controller would have decided on the same
    input. Exit code 0: identical, or compared. 1: not identical, or ticks cannot be judged
    because others are missing. 2: bad input.
    """
    from farhand.laboratory.replay_report import run_replay

    replaced: dict[str, object] = {}
    for key, value in (
        ("margin.kind", margin),
        ("operator.predictor", predictor),
        ("controller.solver", solver),
    ):
        if value is not None:
            replaced[key] = value
    replaced |= dict(parse_setting(setting) for setting in settings or [])
    raise typer.Exit(run_replay(run, replaced, out, as_json))


def _pool(workers: int, scheduler: str) -> "Pool":
    from farhand.laboratory.campaigns.pools import DaskPool, LocalPool

    return DaskPool(scheduler) if scheduler else LocalPool(workers)
