"""What runs there are in a folder: when, what, over what, how it went, how long, how large."""

import fcntl
import os
import struct
import zlib
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import msgspec
from mcap.reader import make_reader
from mcap.records import Chunk
from mcap.stream_reader import StreamReader
from mcap.writer import MCAP0_MAGIC

from farhand.common.errors import InputError, ResultError, RunFileError
from farhand.common.recording.reader import RunReader
from farhand.common.recording.records import RunInfo
from farhand.common.timing.clock import timestamp_in, utc_seconds
from farhand.runs.files import RECORDING, RESULTS, RUN_FILES, SUMMARY
from farhand.runs.summary import read_summary

RECENT = 60.0
"""A recording without an end that was changed in the last minute may be being written to (s)."""
FIRST_CHUNKS = 8
DAY = 86_400.0
SUFFIX = ".mcap"
_FOOTER, _CHECK = struct.Struct("<QQI"), 4
"""At the end of a file: where its summary begins, and its groups; the checksum, which covers all before itself."""


class ListedRun(msgspec.Struct, frozen=True, kw_only=True):
    """Attributes:
    path: its folder, or its recording alone.
    when: its beginning; in virtual time, or without a recording, when its files were written (s since 1970, UTC).
    scenario, network: None: unknown.
    safe, finished: None: unknown.
    length: from the first motion command to the end, else, where no program told that, of the recording (s); None:
        unknown.
    size: of its files (bytes).
    writing: a program is writing there now, or may be.
    writer_known: it is, for certain; where not, what is there may have been cut off just now.
    note: what else is to be said of it.
    """

    path: str
    when: float
    scenario: str | None = None
    network: str | None = None
    safe: bool | None = None
    finished: bool | None = None
    length: float | None = None
    size: int = 0
    writing: bool = False
    writer_known: bool = False
    note: str = ""

    @property
    def result(self) -> str:
        """In words."""
        if self.writing:
            return "is being written" if self.writer_known else "cut off, or being written"
        if self.safe is None and self.finished is None:
            return "unknown"
        safe = "safety unknown" if self.safe is None else "safe" if self.safe else "NOT SAFE"
        return safe if self.finished is None else f"{safe}, {'finished' if self.finished else 'not finished'}"


def list_runs(folder: Path) -> list[ListedRun]:
    """The runs in a folder, or the one that it is, oldest first; raises InputError where it cannot be read."""
    try:
        if not folder.is_dir():
            raise InputError(f"{folder}: no such folder; expected one that holds runs")
        entries = [folder] if is_run(folder) else sorted(folder.iterdir())
    except OSError as error:
        raise InputError(f"{folder}: cannot be read: {error.strerror or error}") from None
    found = [_listed(each) for each in entries]
    return sorted((each for each in found if each is not None), key=lambda each: (each.when, each.path))


def _listed(path: Path) -> ListedRun | None:
    """An entry, as far as it can be read; None: it is no run, or was removed just now."""
    try:
        if not is_run(path):
            return None
        return _of_folder(path) if path.is_dir() else _of_file(path)
    except FileNotFoundError:
        return None
    except OSError as error:
        try:
            when = path.stat().st_mtime
        except OSError:
            return None
        return ListedRun(path=str(path), when=when, note=f"cannot be read: {error.strerror or error}")


def is_run(path: Path) -> bool:
    """Whether it is a recording, or a folder with what a run leaves: a summary, a recording or a program's result."""
    if path.is_dir():
        return any((path / name).is_file() for name in (SUMMARY, RECORDING, *RESULTS))
    return path.suffix == SUFFIX and path.is_file()


def is_written(path: Path) -> bool:
    """Whether a program is writing to a run now, or may be."""
    return has_writer(path) or _grows(path / RECORDING if path.is_dir() else path)


def has_writer(path: Path) -> bool:
    """Whether a program is writing to a run now, by the lock that it has."""
    if not path.is_dir():
        return _is_held(path)
    return _is_held(path) or ((path / RECORDING).is_file() and _is_held(path / RECORDING))


def files_of(path: Path) -> Iterator[Path]:
    """What a run has left: of a folder its files by name, and nothing else that is there."""
    if path.is_dir():
        yield from (path / name for name in RUN_FILES if (path / name).is_file())
    else:
        yield path


def _of_folder(folder: Path) -> ListedRun:
    summary, notes, writing = None, [], is_written(folder)
    try:
        summary = read_summary(folder)
        if summary is None and not writing:
            notes.append(f"no {SUMMARY}")
    except ResultError:
        notes.append(f"{SUMMARY} cannot be read")
    found = _of_file(folder / RECORDING) if (folder / RECORDING).is_file() else None
    if found is not None and summary is not None and found.scenario not in (None, summary.scenario):
        summary = None
        notes.append(f"{SUMMARY} is of another run")
    if found is not None and found.note:
        notes.append(found.note)
    files = list(files_of(folder))
    when = found.when if found is not None else _named(folder, max(each.stat().st_mtime for each in files))
    if summary is not None and summary.end_known:
        length: float | None = summary.duration
    else:
        length = found.length if found is not None else None
    if summary is not None and not summary.end_known:
        notes.append("the operator left no result")
    return ListedRun(
        path=str(folder),
        when=when,
        scenario=summary.scenario if summary is not None else found.scenario if found is not None else None,
        network=summary.network if summary is not None else found.network if found is not None else None,
        safe=summary.safe if summary is not None and summary.safety_known else None,
        finished=summary.finished if summary is not None and summary.end_known else None,
        length=length,
        size=sum(each.stat().st_size for each in files),
        writing=writing,
        writer_known=writing and has_writer(folder),
        note="; ".join(notes),
    )


def _of_file(path: Path) -> ListedRun:
    """A recording by its beginning and its end alone."""
    stat = path.stat()
    named = _named(path.parent if path.name == RECORDING else path, stat.st_mtime)
    known = has_writer(path)
    empty = ListedRun(
        path=str(path),
        when=named,
        size=stat.st_size,
        writing=known or _grows(path),
        writer_known=known,
    )
    try:
        reader = RunReader(path)
    except RunFileError as error:
        why = (
            "recording of another version" if "another version" in str(error) else "recording cannot be read"
        )
        return msgspec.structs.replace(empty, note=why)
    reader.close()
    span, info = _span(path), reader.info
    first_ns = span[0] if span is not None else _first(path) if empty.writing else None
    began = first_ns * 1e-9 if first_ns is not None and info.epoch_ns else named
    return msgspec.structs.replace(
        empty,
        when=began,
        scenario=str(info.scenario.get("name", "")) or None,
        network=_network(info),
        length=(span[1] - span[0]) * 1e-9 if span is not None else None,
        note="" if span is not None or empty.writing else "recording without an end",
    )


def _named(path: Path, changed: float) -> float:
    """When a run was that does not know it itself (s): by its name, which a copy keeps, else when it was changed."""
    named = timestamp_in(path.name)
    return named if named is not None and named < utc_seconds() + DAY else changed


def _span(path: Path) -> tuple[int, int] | None:
    """First and last instant of a recording by the summary at its end (ns); None: it has none that can be trusted."""
    try:
        with path.open("rb") as file:
            size = file.seek(0, os.SEEK_END)
            file.seek(max(0, size - _FOOTER.size - len(MCAP0_MAGIC)))
            start, _, check = _FOOTER.unpack(file.read(_FOOTER.size))
            file.seek(start)
            if not check or zlib.crc32(file.read(size - start - _CHECK - len(MCAP0_MAGIC))) != check:
                return None
            file.seek(0)
            summary = make_reader(file).get_summary()
    except (
        Exception
    ):  # on what is cut or damaged the reader raises its own, struct.error, EOFError and others
        return None
    if summary is None or summary.statistics is None or not summary.statistics.message_count:
        return None
    return summary.statistics.message_start_time, summary.statistics.message_end_time


def _first(path: Path) -> int | None:
    """First instant of a recording that is being written, by its first chunks (ns); None: there is none yet.

    What is written at once may stand in any order: several chunks are looked at.
    """
    instants: list[int] = []
    try:
        with path.open("rb") as file:
            chunks = (
                each for each in StreamReader(file, emit_chunks=True).records if isinstance(each, Chunk)
            )
            instants.extend(chunk.message_start_time for chunk in islice(chunks, FIRST_CHUNKS))
    except Exception:  # at the end of what is written so far, as in _span
        pass
    return min(instants, default=None)


def _network(info: RunInfo) -> str | None:
    table = info.scenario.get("network")
    if not isinstance(table, dict):
        return None
    up, down = table.get("uplink"), table.get("downlink")
    return None if up is None and down is None else str(up) if up == down else f"{up} / {down}"


def _grows(recording: Path) -> bool:
    try:
        if utc_seconds() - recording.stat().st_mtime > RECENT:
            return False
        with recording.open("rb") as file:
            file.seek(max(0, recording.stat().st_size - len(MCAP0_MAGIC)))
            return file.read() != bytes(MCAP0_MAGIC)
    except OSError:
        return False


def _is_held(path: Path) -> bool:
    """Whether a program has the folder for itself (see hold_folder), or the recording (see RunFile)."""
    try:
        opened = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    except OSError:
        return False
    try:
        fcntl.flock(opened, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return False
    finally:
        os.close(opened)
    return False
