"""`farhand simulate`: the demo's task, summary and figure in virtual time."""

import sys
from pathlib import Path

from rich.console import Console

from farhand.laboratory.simulation import simulate
from farhand.runs.figure import draw_run
from farhand.runs.report import print_outcome
from farhand.runs.run_folder import RECORDING, make_run_folder, write_scenario
from farhand.runs.scenario import Scenario
from farhand.runs.summary import write_summary


def run_simulation(
    scenario: Scenario,
    *,
    uplink: str,
    downlink: str,
    seed: int,
    time_limit: float,
    computing_time: float,
    timeline: str | None,
    out: Path | None,
    as_json: bool,
) -> int:
    """Run one task in virtual time; returns 0 if it was safe and finished, else 1."""
    folder = make_run_folder(out, scenario.name)
    write_scenario(scenario, folder)
    result = simulate(
        scenario,
        uplink=uplink,
        downlink=downlink,
        seed=seed,
        time_limit=time_limit,
        computing_time=computing_time,
        timeline=timeline,
        keep_reports=True,
        record_to=folder / RECORDING,
    )
    write_summary(result.summary, folder)
    began = next((r.t_sent_ns for r in result.reports if r.mode == "run"), 0)
    series = [
        ((r.t_sent_ns - began) * 1e-9, r.rtt, r.sigma, r.inflation, r.clearance) for r in result.reports
    ]
    figure = draw_run(scenario, result.summary, result.trajectory, series, folder)
    console = Console(file=sys.stderr if as_json else sys.stdout)
    print_outcome(result.summary, folder, figure, console, as_json=as_json, network=result.network)
    return result.summary.exit_code
