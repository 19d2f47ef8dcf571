"""`farhand runs`: the list of runs, and the pruning of it."""

from collections.abc import Callable, Sequence
from pathlib import Path

import msgspec
from rich.console import Console

from farhand.common.errors import InputError
from farhand.common.process.console import page
from farhand.common.timing.clock import local_words
from farhand.runs.shelf.listing import ListedRun, list_runs
from farhand.runs.shelf.pruning import Bounds, beyond, remove


def run_list(folder: Path, as_json: bool) -> int:
    """Print what is there; returns 0. Raises InputError."""
    runs = list_runs(folder)
    if as_json:
        print(msgspec.json.encode({"runs": runs}).decode(), flush=True)
    elif runs:
        print_runs(runs, page())
    else:
        print(f"{folder}: holds no run")
    return 0


def run_prune(folder: Path, bounds: Bounds, ask: Callable[[str], bool] | None, as_json: bool) -> int:
    """Remove what is beyond the bounds; returns 0, or 1 where something of it stays against the wish.

    Args:
        folder: of the runs.
        bounds: see Bounds.
        ask: whether to, None: it was said already.
        as_json: print what went as the last line.

    Raises InputError.
    """
    if bounds.none:
        raise InputError("--prune: say what may go: --older-than DAYS, --keep NUMBER or --max-size MB")
    going, console = beyond(list_runs(folder), bounds), page(stderr=as_json)
    if going and ask is not None:
        print_runs(going, console)
        many = f"{len(going)} runs" if len(going) > 1 else "1 run"
        if not ask(f"remove {many}, {size_words(sum(each.size for each in going))}?"):
            going = []
    gone, code = [], 0
    for run in going:
        said = remove(Path(run.path))
        if said:
            console.print(f"{run.path}: {said}", highlight=False, markup=False, soft_wrap=True)
        if not said or said.startswith("is gone"):
            gone.append(run.path)
        else:
            code = 1
    console.print(f"{len(gone)} removed", highlight=False)
    if as_json:
        print(msgspec.json.encode({"removed": gone}).decode(), flush=True)
    return code


def print_runs(runs: Sequence[ListedRun], console: Console) -> None:
    """Two lines for each, which 80 columns hold: when, what, how it went; and where it is, over what network."""
    head = ("when", "scenario", "result", "length", "size")
    rows = [
        (
            local_words(run.when),
            run.scenario or "unknown",
            run.result,
            "–" if run.length is None else length_words(run.length),
            size_words(run.size),
        )
        for run in runs
    ]
    widths = [max(map(len, column)) for column in zip(head, *rows, strict=True)]
    console.print(_line(head, widths), style="bold", highlight=False, markup=False, soft_wrap=True)
    for run, row in zip(runs, rows, strict=True):
        console.print(_line(row, widths), highlight=False, markup=False, soft_wrap=True)
        about = [Path(run.path).name, f"over {run.network}" if run.network else "", run.note]
        said = "; ".join(part for part in about if part)
        console.print(f"    {said}", style="dim", highlight=False, markup=False, soft_wrap=True)


def _line(cells: Sequence[str], widths: Sequence[int]) -> str:
    """Words to the left, quantities to the right."""
    *words, length, size = zip(cells, widths, strict=True)
    left = "  ".join(cell.ljust(width) for cell, width in words)
    right = "  ".join(cell.rjust(width) for cell, width in (length, size))
    return f"{left}  {right}"


def length_words(seconds: float) -> str:
    """`14.8 s`, `12:03`, `1:00:00`."""
    if seconds < 60.0:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"


def size_words(size: int) -> str:
    """`1.1 MB`."""
    return f"{size / 1e9:.1f} GB" if size >= 1e9 else f"{size / 1e6:.1f} MB"
