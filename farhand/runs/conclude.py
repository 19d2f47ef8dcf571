"""`farhand summarise`: the summary and the figure of a run whose programs left their results in a folder."""

import sys
from pathlib import Path

from rich.console import Console

from farhand.common.errors import InputError
from farhand.runs.figure import draw_run
from farhand.runs.report import print_outcome
from farhand.runs.run_folder import (
    NETEM,
    OPERATOR,
    ROBOT,
    read_json,
    read_operator_result,
    summarise_folder,
    write_scenario,
)
from farhand.runs.scenario import Scenario
from farhand.runs.summary import write_summary


def run_summarise(
    folder: Path, scenario: Scenario, *, uplink: str, downlink: str, seed: int, why: str, as_json: bool
) -> int:
    """Write `summary.json`, the scenario and the figure; returns 0 if the run was safe and finished, else 1.

    Raises InputError where there is no folder, or nothing in it.
    """
    if not any((folder / name).is_file() for name in (OPERATOR, ROBOT)):
        raise InputError(
            f"{folder}: holds neither {OPERATOR} nor {ROBOT}, which the programs write at --result"
        )
    write_scenario(scenario, folder)
    console = Console(file=sys.stderr if as_json else sys.stdout)
    return conclude(
        folder, scenario, console, uplink=uplink, downlink=downlink, seed=seed, why=why, as_json=as_json
    )


def conclude(
    folder: Path,
    scenario: Scenario,
    console: Console,
    *,
    uplink: str,
    downlink: str,
    seed: int,
    why: str,
    as_json: bool,
) -> int:
    """Make summary and figure of what the programs left in the folder, and print how it went.

    Returns 0 if the run was safe and finished, else 1.
    """
    summary = summarise_folder(folder, scenario, seed=seed, uplink=uplink, downlink=downlink, why=why)
    write_summary(summary, folder)
    operator, trajectory = read_operator_result(folder), read_json(folder / ROBOT).get("trajectory", [])
    series = operator.series if operator is not None else []
    figure = draw_run(scenario, summary, trajectory, series, folder) if trajectory else None
    if operator is not None and operator.notice:
        console.print(operator.notice, style="yellow", markup=False)
    print_outcome(summary, folder, figure, console, as_json=as_json, network=read_json(folder / NETEM))
    return summary.exit_code
