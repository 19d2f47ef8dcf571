"""Which recordings a coverage is measured over, and how each is called in its table."""

import os
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

from farhand.common.errors import FarhandError, InputError
from farhand.netem.recordings.trace import load_trace


def find_traces(paths: Sequence[Path]) -> tuple[dict[str, str], list[FarhandError]]:
    """SPEC of each recording by its name, and why files of the folders were left out.

    Args:
        paths: recordings, and folders that stand for those of their files that can be read.

    Raises TraceError for a recording that cannot be read, InputError for a folder without any that can.
    """
    found: dict[Path, Path] = {}
    left_out: list[FarhandError] = []
    for path in paths:
        files = list(_readable(path, left_out)) if path.is_dir() else [path]
        if not files:
            raise InputError(f"--trace {path}: no file in it can be read as a recording of delays")
        if not path.is_dir():
            load_trace(path)
        found |= {Path(os.path.abspath(file)): file for file in files}
    return {name: f'trace:"{found[whole]}"' for name, whole in _short_names(list(found)).items()}, left_out


def _readable(folder: Path, left_out: list[FarhandError]) -> Iterator[Path]:
    for file in sorted(each for each in folder.rglob("*") if each.is_file()):
        try:
            load_trace(file)
        except FarhandError as error:
            left_out.append(error)
        else:
            yield file


def _short_names(files: Sequence[Path]) -> dict[str, Path]:
    """Each file by its name, with as much of its folder before it as tells it from the others."""
    tails = Counter(tail for file in files for tail in _tails(file))
    return {str(next(tail for tail in _tails(file) if tails[tail] == 1)): file for file in files}


def _tails(file: Path) -> list[Path]:
    """The ends of a path, the shortest first."""
    return [Path(*file.parts[-count:]) for count in range(1, len(file.parts) + 1)]
