"""Which runs are too old, too many or too large, and how they go: their own files, and no other."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from farhand.common.errors import InputError
from farhand.common.process.outputs import hold_folder
from farhand.common.timing.clock import utc_seconds
from farhand.runs.shelf.listing import ListedRun, files_of, is_run, is_written

DAY = 86_400.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Bounds:
    """Attributes:
    days: older runs go.
    number: so many stay, the newest.
    size: so much stays of the newest (bytes).
    """

    days: float | None = None
    number: int | None = None
    size: float | None = None

    @property
    def none(self) -> bool:
        """Whether nothing is bounded."""
        return self.days is None and self.number is None and self.size is None


def beyond(runs: Sequence[ListedRun], bounds: Bounds) -> list[ListedRun]:
    """The runs that are beyond any of the bounds, oldest first; what is being written to never is."""
    now, found, total = utc_seconds(), [], 0
    for place, run in enumerate(sorted(runs, key=lambda each: each.when, reverse=True)):
        total += run.size
        too_old = bounds.days is not None and now - run.when > bounds.days * DAY
        too_many = bounds.number is not None and place >= bounds.number
        too_large = bounds.size is not None and total > bounds.size
        if (too_old or too_many or too_large) and not run.writing:
            found.append(run)
    return found[::-1]


def remove(path: Path) -> str:
    """Take a run's files away, and its folder where that is empty then; what it says why not, or what stays.

    A link, a folder that is no run, and one that a program is writing to stay as they are.
    """
    try:
        return _remove(path)
    except OSError as error:
        return f"cannot be removed: {error.strerror or error}"


def _remove(path: Path) -> str:
    if path.is_symlink() or not is_run(path):
        return "is no run of its own"
    if is_written(path):
        return "is being written to"
    if path.is_dir():
        try:
            hold_folder(path, "run")
        except InputError:
            return "is being written to"
    for file in list(files_of(path)):
        file.unlink()
    if path.is_dir():
        with suppress(OSError):
            path.rmdir()
        if path.is_dir():
            return "is gone; other files in its folder stay"
    return ""
