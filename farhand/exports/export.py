"""`farhand export`: recordings in the form of somebody else's tools."""

from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

from farhand.common.errors import InputError, RunFileError
from farhand.common.process.signals import say
from farhand.exports.axes import ACTIONS, VELOCITY
from farhand.exports.output import need, whole_folder
from farhand.exports.source import Run, Source, run_at

Write = Callable[[Sequence[Run], Path], list[Source]]
PACKAGES: dict[str, tuple[str, ...]] = {
    "lerobot": ("pyarrow", "av"),
    "rosbag2": ("rosbags",),
    "csv": (),
    "parquet": ("pyarrow",),
}
"""The forms, and what each needs beyond Farhand's own."""


def run_export(
    paths: Sequence[Path], form: str, out: Path, *, force: bool = False, actions: str | None = None
) -> int:
    """Write recordings in another form; returns 0, or 1 where something is missing, which is said.

    Args:
        paths: folders or files of runs.
        form: see PACKAGES.
        out: folder to make.
        force: replace an export that is there.
        actions: of a LeRobot dataset: `velocity` or `position`; None: nothing is said.

    Raises:
        InputError: a run cannot be read, `out` cannot be written, a package is not installed.
    """
    if form not in PACKAGES:
        raise InputError(f"--to {form!r}: expected one of {', '.join(PACKAGES)}")
    if actions is not None and form != "lerobot":
        raise InputError(f"--actions: goes with --to lerobot, not with --to {form}")
    if actions is not None and actions not in ACTIONS:
        raise InputError(f"--actions {actions!r}: expected {' or '.join(ACTIONS)}")
    need(PACKAGES[form], form)
    runs = _named([run_at(path) for path in paths])
    with whole_folder(out, force=force) as stage:
        sources = _writer(form, actions or VELOCITY)(runs, stage)
        _check_something(sources)
    for source in sources:
        for note in source.notes:
            say("export", f"{source.run.path}: {note}")
    ticks = sum(source.ticks for source in sources)
    say("export", f"{ticks} ticks of {len(runs)} run{'s' if len(runs) > 1 else ''} as {form} in {out}")
    return 1 if any(source.notes for source in sources) else 0


def _writer(form: str, actions: str) -> Write:
    if form == "lerobot":
        from farhand.exports.lerobot import write_dataset

        return lambda runs, folder: write_dataset(runs, folder, actions=actions)
    if form == "rosbag2":
        from farhand.exports.rosbag import write_bag

        return write_bag
    from farhand.exports.to_tables import write_tables

    return lambda runs, folder: write_tables(runs, form, folder)


def _named(runs: list[Run]) -> list[Run]:
    """The runs, those of one name numbered."""
    total, seen = Counter(run.name for run in runs), Counter[str]()
    named = []
    for run in runs:
        seen[run.name] += 1
        named.append(Run(f"{run.name}-{seen[run.name]}" if total[run.name] > 1 else run.name, run.path))
    return named


def _check_something(sources: Sequence[Source]) -> None:
    for source in sources:
        if not source.ticks:
            raise RunFileError(
                f"run {source.run.path}: holds no tick; expected a recording of a run that began"
            )
