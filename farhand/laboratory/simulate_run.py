"""`farhand simulate`: the demo's task, summary and figure in virtual time."""

from collections.abc import Callable
from pathlib import Path

from farhand.common.errors import InputError
from farhand.common.process.console import page
from farhand.common.process.outputs import survive
from farhand.common.process.signals import say, stopped_by_signals
from farhand.laboratory.simulation import simulate_run
from farhand.operator_side.accounts.result import sample_of
from farhand.operator_side.control.registry import make_controller
from farhand.operator_side.steering.hand.remote import Remote
from farhand.operator_side.steering.registry import DEVICES
from farhand.programs.compiling import prepare_aloud, prepare_robot_aloud
from farhand.report.write import conclude_report
from farhand.runs.figure import draw_run
from farhand.runs.files import FIGURE, RECORDING, SCENARIO, SUMMARY
from farhand.runs.report import print_outcome
from farhand.runs.run import Run
from farhand.runs.run_folder import make_run_folder, write_scenario
from farhand.runs.summary import write_summary


def run_simulation(run: Run, *, out: Path | None, as_json: bool, force: bool = False) -> int:
    """Do a run in virtual time; returns 0 if it was safe and finished, else 1.

    Ctrl-C, SIGTERM or SIGHUP end it where it is, with the summary of what was.
    """
    _check_device(run)
    run.check()
    folder = make_run_folder(out, run.scenario.name, force=force)

    def tell(line: str) -> None:
        say("simulate", line)

    def keep(name: str, write: Callable[[], Path]) -> Path | None:
        return survive(str(folder / name), write, tell)

    prepare_robot_aloud(run.scenario, tell)
    prepare_aloud(make_controller(run.scenario.controller), tell)
    keep(SCENARIO, lambda: write_scenario(run, folder))
    with stopped_by_signals() as stopped:
        result = simulate_run(run, keep_reports=True, record_to=folder / RECORDING, stop=stopped.is_set)
    if result.recording_trouble:
        tell(f"{folder / RECORDING}: {result.recording_trouble}")
    written = keep(SUMMARY, lambda: write_summary(result.summary, folder))
    began_ns = next((report.t_sent_ns for report in result.reports if report.mode == "run"), 0)
    series = [sample_of(report, began_ns) for report in result.reports]
    figure = keep(
        FIGURE,
        lambda: draw_run(
            run.scenario, result.summary, result.trajectory, series, folder, result.silences, result.guarding
        ),
    )
    console = page(stderr=as_json)
    print_outcome(result.summary, folder if written else None, figure, console, as_json=as_json)
    conclude_report(folder, console)
    return result.summary.exit_code


def _check_device(run: Run) -> None:
    """Raise InputError where a hand would have to steer."""
    kind = run.scenario.steering.kind
    if issubclass(DEVICES.get(kind, "steering.kind"), Remote):
        raise InputError(
            f"--steer {kind}: nobody steers in virtual time; say `farhand demo`, or --steer recorded:RUN, which plays "
            "what was asked in a recorded run"
        )
