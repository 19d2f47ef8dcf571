"""Runs as tables: runs, ticks, states, messages, happenings."""

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.common.recording.decoded import DecodedTick
from farhand.common.recording.fates import Fate
from farhand.exports.source import Run, Source, joints_of
from farhand.exports.table_files import FORMS, TableFile, describe
from farhand.exports.tables import happening_row, message_row, run_row, state_row, tables, tick_row
from farhand.foxglove.happenings import Happening, Happenings


def write_tables(runs: Sequence[Run], form: str, folder: Path) -> list[Source]:
    """Write them; returns what was read of each run.

    Args:
        runs: the recordings.
        form: `csv` or `parquet`.
        folder: an empty one.

    Raises:
        RunFileError: a recording cannot be read.
    """
    columns = tables(max(map(joints_of, runs), default=0))
    describe(folder, columns)
    with ExitStack() as closing:
        files: dict[str, TableFile] = {}
        for name, each in columns.items():
            files[name] = FORMS[form](folder / f"{name}.{form}", each)
            closing.callback(files[name].close)
        return [_write(run, files) for run in runs]


def _write(run: Run, files: dict[str, TableFile]) -> Source:
    source = Source(run)
    start_ns: int | None = None
    happenings = Happenings()
    for item in source.items(fates=True):
        if isinstance(item, Fate):
            files["messages"].add(message_row(run.name, item))
        elif isinstance(item, DecodedTick):
            start_ns = item.record.now_ns if start_ns is None else start_ns
            _tick(run.name, item, files, happenings, start_ns)
    for happening in happenings.end():
        files["happenings"].add(happening_row(run.name, happening, start_ns or 0))
    files["runs"].add(run_row(source, start_ns or 0))
    return source


def _tick(
    run: str, tick: DecodedTick, files: dict[str, TableFile], follows: Happenings, start_ns: int
) -> None:
    files["ticks"].add(tick_row(run, tick, start_ns))
    over: list[Happening] = []
    for arrived_ns, _, message in tick.arrived:
        if isinstance(message, RobotState):
            files["states"].add(state_row(run, tick.record.number, arrived_ns, message, start_ns))
    for arrived_ns, _, message in tick.news:
        if isinstance(message, RobotState):
            over += follows.state(message, arrived_ns)
        elif isinstance(message, Scene):
            over += follows.scene(message, arrived_ns)
    if tick.report is not None:
        over += follows.tick(tick.report, tick.record.now_ns)
    for happening in over:
        files["happenings"].add(happening_row(run, happening, start_ns))
