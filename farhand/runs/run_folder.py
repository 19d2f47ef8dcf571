"""The folder of a run: where it is, what lies in it, and the summary made of it."""

from pathlib import Path

import tomli_w

from farhand.common.errors import InputError
from farhand.common.timing.clock import local_timestamp
from farhand.runs.files import RECORDING, RESULTS, SCENARIO, SUMMARY
from farhand.runs.results import RunResults
from farhand.runs.run import Run
from farhand.runs.summary import RunSummary, summarise
from farhand.runs.why import unfinished


def make_run_folder(out: Path | None, name: str) -> Path:
    """The folder for a run's files, made if need be; raises InputError where that cannot be."""
    folder = out if out is not None else Path("runs") / f"{local_timestamp()}-{name}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / ".writable"
        probe.write_bytes(b"")
        probe.unlink()
    except OSError as error:
        raise InputError(f"--out {folder}: cannot be written: {error.strerror}") from None
    for stale in (*RESULTS, RECORDING, SUMMARY):
        (folder / stale).unlink(missing_ok=True)
    return folder


def write_scenario(run: Run, folder: Path) -> Path:
    """The scenario with all options and the network in force, as TOML: what the programs load, and can be run again."""
    path = folder / SCENARIO
    path.write_text(tomli_w.dumps(run.table()), encoding="utf-8")
    return path


def summarise_results(run: Run, results: RunResults, why: str = "") -> RunSummary:
    """The summary of a run of the three programs from what they left; says what is missing, unless `why` does."""
    operator = results.operator
    if operator is None:
        why = why or "the operator's program left no result"
    elif not operator.finished:
        why = why or unfinished(operator.last_report, run)
    if results.robot is None:
        why = why or "the robot's program left no result"
    return summarise(run, results, real_time=True, why=why)
