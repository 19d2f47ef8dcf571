"""`farhand summarise`: the summary and the figure of a run whose programs left their results in a folder."""

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import msgspec
from rich.console import Console

from farhand.common.errors import InputError
from farhand.common.process.console import page
from farhand.common.process.outputs import survive
from farhand.common.process.signals import say
from farhand.common.result_file import write_whole
from farhand.runs.figure import draw_run
from farhand.runs.files import FIGURE, OPERATOR, RESULTS, ROBOT, SCENARIO, SUMMARY
from farhand.runs.report import print_outcome
from farhand.runs.results import read_results
from farhand.runs.run import Run
from farhand.runs.run_folder import summarise_results, write_scenario
from farhand.runs.scenario import load_scenario
from farhand.runs.summary import write_summary

T = TypeVar("T")


def scenario_of_folder(folder: Path, asked: str | None) -> str:
    """The scenario of a run's folder: its own file, else what was asked for, else ur5-obstacle.

    Raises InputError where both are there and are not the same scenario: a summary of another task would be false.
    """
    own = folder / SCENARIO
    if not own.is_file():
        return asked or "ur5-obstacle"
    if asked is not None:
        kept, other = load_scenario(str(own)), load_scenario(asked)
        if msgspec.structs.replace(other, network=kept.network) != kept:
            raise InputError(
                f"--scenario {asked}: {folder} holds another scenario, {kept.name!r}, in {SCENARIO}; "
                "leave --scenario out, or take that file away"
            )
    return str(own)


def run_summarise(run: Run, folder: Path, *, why: str, as_json: bool) -> int:
    """Write `summary.json`, the scenario and the figure; returns 0 if the run was safe and finished, else 1.

    Raises InputError where there is no folder, nothing in it, or something that cannot be read.
    """
    if not any((folder / name).is_file() for name in (OPERATOR, ROBOT)):
        raise InputError(
            f"{folder}: holds neither {OPERATOR} nor {ROBOT}, which the programs write at --result"
        )
    console = page(stderr=as_json)
    code = conclude(run, folder, console, why=why, as_json=as_json)
    survive(str(folder), lambda: write_scenario(run, folder), lambda line: say("summarise", line))
    return code


def conclude(
    run: Run,
    folder: Path,
    console: Console,
    *,
    why: str,
    as_json: bool,
    left_in: Path | None = None,
    note: str = "",
) -> int:
    """Make summary and figure of what the programs left behind, and print how it went.

    Args:
        run: what was done.
        folder: where summary and figure go.
        console: where the outcome goes.
        why: what went wrong, where the results cannot say it.
        as_json: print the summary as the last line.
        left_in: where the programs left their results; None: in `folder`. Elsewhere, they are copied there.
        note: what else there is to say, such as what a recording lacks.

    Returns 0 if the run was safe and finished, else 1. Raises ResultError where a result cannot be read.
    """

    def keep(name: str, write: Callable[[], T]) -> T | None:
        return survive(
            str(folder / name), write, lambda line: console.print(line, style="yellow", markup=False)
        )

    results = read_results(left_in or folder)
    if left_in is not None:
        for left in (left_in / name for name in RESULTS):
            if left.is_file():
                keep(left.name, lambda left=left: write_whole(folder / left.name, left.read_bytes()))  # type: ignore[misc]
    summary = summarise_results(run, results, why)
    written = keep(SUMMARY, lambda: write_summary(summary, folder))
    trajectory = results.robot.trajectory if results.robot is not None else []
    series = results.operator.series if results.operator is not None else []
    silences = results.operator.silences if results.operator is not None else []
    guarding = results.operator.guarding if results.operator is not None else []
    figure = (
        keep(FIGURE, lambda: draw_run(run.scenario, summary, trajectory, series, folder, silences, guarding))
        if trajectory
        else None
    )
    if results.operator is not None and results.operator.notice:
        console.print(results.operator.notice, style="yellow", markup=False)
    if note:
        console.print(note, style="yellow", markup=False)
    print_outcome(summary, folder if written else None, figure, console, as_json=as_json)
    return summary.exit_code
