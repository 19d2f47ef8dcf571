"""`farhand report`: reads, writes the page, prints the JSON."""

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from farhand.common.errors import InputError
from farhand.common.process.outputs import check_writable, survive
from farhand.common.recording.place import recording_at
from farhand.common.result_file import write_whole
from farhand.report.as_json import to_json
from farhand.report.page import Page
from farhand.report.reading.evidence import read_evidence
from farhand.runs.files import REPORT


def write_report(folder: Path) -> Path:
    """The page of a run into its folder; raises InputError where it has no recording, OSError where it has no place."""
    out = folder / REPORT
    write_whole(out, Page([read_evidence(folder)]).html())
    return out


def conclude_report(folder: Path, console: Console) -> None:
    """Write the report at the end of a run, which does not depend on it, and say where it is, or why there is none."""

    def tell(line: str) -> None:
        console.print(line, style="yellow", markup=False, highlight=False)

    try:
        written = survive(str(folder / REPORT), lambda: write_report(folder), tell)
    except InputError as error:
        tell(f"no {REPORT}: {error}")
        return
    if written is not None:
        console.print(f"what happened, on one page: {written}", highlight=False, markup=False, soft_wrap=True)


def run_report(runs: Sequence[Path], out: Path | None, as_json: bool) -> int:
    """Write the page of one run or two, or with `as_json` print their figures; returns 0. Raises InputError."""
    for each in runs:
        recording_at(each)  # before it is asked where the page goes
    wanted = out if out is not None or as_json else _beside(runs)
    check_writable(wanted, "--out")
    found = [read_evidence(each) for each in runs]
    if wanted is not None:
        try:
            write_whole(wanted, Page(found).html())
        except OSError as error:
            raise InputError(f"--out {wanted}: cannot be written: {error.strerror or error}") from None
    if as_json:
        print(to_json(found), flush=True)
        return 0
    for run in found:
        for line in run.lacks:
            print(f"{run.name}: {line}")
    print(f"report: {wanted}")
    return 0


def _beside(runs: Sequence[Path]) -> Path:
    """Where the page goes if nothing is said: into the run's folder, or beside the file; of two into this folder."""
    if len(runs) == 1:
        return runs[0] / REPORT if runs[0].is_dir() else runs[0].with_suffix(".html")
    names = [each.resolve().name.removesuffix(".mcap") for each in runs]
    return Path(f"report-{names[0]}-{names[1]}.html")
