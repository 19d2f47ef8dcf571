"""`farhand summarise`: the summary and the figure of a run whose programs left their results in a folder."""

from pathlib import Path

from rich.console import Console

from farhand.common.errors import InputError
from farhand.runs.console import page
from farhand.runs.figure import draw_run
from farhand.runs.files import OPERATOR, ROBOT
from farhand.runs.report import print_outcome
from farhand.runs.results import read_results
from farhand.runs.run import Run
from farhand.runs.run_folder import summarise_results, write_scenario
from farhand.runs.summary import write_summary


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
    write_scenario(run, folder)
    return code


def conclude(run: Run, folder: Path, console: Console, *, why: str, as_json: bool) -> int:
    """Make summary and figure of what the programs left in the folder, and print how it went.

    Returns 0 if the run was safe and finished, else 1. Raises ResultError where a result cannot be read.
    """
    results = read_results(folder)
    summary = summarise_results(run, results, why)
    write_summary(summary, folder)
    trajectory = results.robot.trajectory if results.robot is not None else []
    series = results.operator.series if results.operator is not None else []
    silences = results.operator.silences if results.operator is not None else []
    figure = draw_run(run.scenario, summary, trajectory, series, folder, silences) if trajectory else None
    if results.operator is not None and results.operator.notice:
        console.print(results.operator.notice, style="yellow", markup=False)
    print_outcome(summary, folder, figure, console, as_json=as_json)
    return summary.exit_code
