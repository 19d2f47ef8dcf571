"""The folder of a run: where it is, what lies in it, and the summary made of it."""

from pathlib import Path

import tomli_w

from farhand.common.errors import InputError
from farhand.common.process.outputs import hold_folder, make_folder
from farhand.common.result_file import write_whole
from farhand.common.timing.clock import local_timestamp
from farhand.runs.files import RUN_FILES, SCENARIO
from farhand.runs.results import RunResults
from farhand.runs.run import Run
from farhand.runs.summary import RunSummary, summarise
from farhand.runs.why import unfinished


def make_run_folder(out: Path | None, name: str, *, force: bool = False) -> Path:
    """The folder for a run's files, made if need be, and this process's alone until it ends.

    Args:
        out: where; None: `runs/TIME-NAME`, which no other run has.
        name: of the run.
        force: replace the run that is there; what is no run's file stays.

    Raises:
        InputError: it cannot be written, another run is writing there, or one is there already.
    """
    folder = out if out is not None else _new_folder(name)
    make_folder(folder, "--out")
    hold_folder(folder, "--out")
    used = [each for each in RUN_FILES if (folder / each).exists()]
    if used and not force:
        raise InputError(
            f"--out {folder}: holds a run already ({used[0]}); choose another folder, or --force to replace it"
        )
    for stale in used:
        (folder / stale).unlink()
    return folder


def _new_folder(name: str) -> Path:
    """A folder that is made here, so that two runs that begin in the same second have one each."""
    first = Path("runs") / f"{local_timestamp()}-{name}"
    for number in range(1, 1000):
        folder = first if number == 1 else first.with_name(f"{first.name}-{number}")
        try:
            folder.mkdir(parents=True)
        except FileExistsError:
            continue
        except OSError:
            pass  # told by whoever tries to write there
        return folder
    return first


def write_scenario(run: Run, folder: Path) -> Path:
    """The scenario with all options and the network in force, as TOML: what the programs load, and can be run again."""
    path = folder / SCENARIO
    write_whole(path, tomli_w.dumps(run.table()))
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
