"""Where a run's recording is."""

from pathlib import Path

from farhand.common.errors import RunFileError
from farhand.runs.files import RECORDING


def recording_at(path: Path) -> Path:
    """The recording of a run, by its folder or its file; raises RunFileError where there is none."""
    found = path / RECORDING if path.is_dir() else path
    if not found.is_file():
        raise RunFileError(f"run {path}: no such file; expected a run's folder or its {RECORDING}")
    return found
