"""`farhand benchmark`: methods against each other."""

from pathlib import Path
from typing import Annotated

import typer

from farhand.commands.options import JsonOption, WorkersOption
from farhand.common.timing.clock import local_timestamp

benchmark_app = typer.Typer(help="Methods against each other, on the same tasks.", no_args_is_help=True)


@benchmark_app.callback()
def benchmark() -> None:
    """Methods against each other, on the same tasks."""


@benchmark_app.command()
def safety(
    quick: Annotated[
        bool, typer.Option("--quick", help="Two networks, two tasks: ten minutes on two cores.")
    ] = False,
    tasks: Annotated[
        int | None,
        typer.Option(
            min=1, max=100_000, help="In a cell of the sphere with the tester; others have fewer (20)."
        ),
    ] = None,
    networks: Annotated[
        list[str] | None,
        typer.Option(help="Names with commas between, or a SPEC such as trace:FILE; again for more."),
    ] = None,
    scenes: Annotated[str, typer.Option(help="Names with commas between (all).")] = "",
    methods: Annotated[str, typer.Option(help="Names, or module:Class, with commas between (all).")] = "",
    operators: Annotated[str, typer.Option(help="Some of tester,person,hostile.")] = "",
    seed: Annotated[int, typer.Option(min=0, help="Of tasks, networks and operators.")] = 1,
    task: Annotated[int | None, typer.Option(min=0, help="Run this one task alone.")] = None,
    workers: WorkersOption = 0,
    dask: Annotated[str, typer.Option(help="Address of a Dask scheduler, such as tcp://host:8786.")] = "",
    out: Annotated[
        Path | None, typer.Option("--out", help="Folder for the results; a table in it goes on.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Networks x scenes x methods x operators in virtual time: the leaderboard.

    Exit code 0: done. 1: a run crashed. 2: bad input. A table that was stopped goes on with the same --out; more
    tasks, networks, scenes, methods or operators add to it.
    """
    from farhand.laboratory.campaigns.pools import DaskPool, LocalPool
    from farhand.trials.leaderboard.choice import chosen_board
    from farhand.trials.leaderboard.run_board import run_board

    board = chosen_board(
        quick=quick,
        tasks=tasks,
        networks=networks,
        scenes=scenes,
        methods=methods,
        operators=operators,
        seed=seed,
        only=task,
    )
    folder = out if out is not None else Path("runs") / f"{local_timestamp()}-safety"
    pool = DaskPool(dask, "--dask") if dask else LocalPool(workers)
    raise typer.Exit(run_board(board, pool, folder, as_json=as_json))
