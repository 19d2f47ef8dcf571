"""A campaign's folder: what it is, its finished rows as they come, and the tables made of them.

`campaign.json` holds the settings, seed and versions; `rows.jsonl` one line a finished run, written at once,
so that a campaign that is stopped goes on where it stopped; `tasks.csv` all rows in their fixed order.
"""

import csv
import hashlib
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Generic, Protocol, TextIO, TypeVar

import msgspec

from farhand.common.errors import InputError
from farhand.common.process.outputs import hold_folder, make_folder
from farhand.common.result_file import write_whole
from farhand.laboratory.campaigns.jobs import UNITS, Row

CAMPAIGN, ROWS, TABLE = "campaign.json", "rows.jsonl", "tasks.csv"
_WRITTEN = (ROWS, TABLE, "tasks.parquet", "index.html", "leaderboard.md", "table1.json", "table1.md")
"""Of campaigns."""
SELECTION = "selection"
"""Key of the settings that only say which rows are wanted."""
FIELDS = tuple(name for name in Row.__struct_fields__ if name not in ("key", "labels"))
"""Of a run's row."""


class Keyed(Protocol):
    """What has a name of its own within its campaign: a job, and the row that came of it."""

    @property
    def key(self) -> str:
        """The name."""
        ...


class Kept(Keyed, Protocol):
    """What every kind of row says."""

    @property
    def seed(self) -> int:
        """Of its draws."""
        ...

    @property
    def duration(self) -> float | None:
        """In virtual time (s); None without a result."""
        ...

    @property
    def error(self) -> str:
        """What crashed; empty: nothing."""
        ...


R = TypeVar("R", bound=Kept)
K = TypeVar("K", bound=Keyed)


class Store(Generic[R]):
    """Finished rows on disk.

    Args:
        folder: made if need be.
        about: settings, seed and versions; a folder that holds another campaign is refused.
        kind: of the rows, a msgspec Struct.

    Attributes:
        rows: finished, by key.
        crashed: those without a result that were there before, by key: they are missing, and run again.
        trouble: why finished rows are not on the disk, in words; empty: they are.

    Raises:
        InputError: the folder cannot be written, holds another campaign, or another program runs it.
    """

    def __init__(
        self,
        folder: Path,
        about: dict[str, Any],
        kind: type[R] = Row,  # type: ignore[assignment]
    ) -> None:
        self.folder = folder
        self._kind = kind
        self.trouble = ""
        self._stream: TextIO | None = None
        try:
            make_folder(folder, "--out")
            hold_folder(folder, "--out")
            self._claim(about)
            self.crashed: dict[str, R] = {}
            self.rows = self._read()
            self._stream = (folder / ROWS).open("a", encoding="utf-8")
        except OSError as error:
            raise InputError(f"--out {folder}: cannot be written: {error.strerror or error}") from None

    def add(self, row: R) -> bool:
        """Keep a finished row; False if it was there already."""
        if row.key in self.rows:
            return False
        self.rows[row.key] = row
        self.crashed.pop(row.key, None)
        if self._stream is not None:
            try:
                self._stream.write(msgspec.json.encode(row).decode() + "\n")
                self._stream.flush()
            except OSError as error:
                self._fail(error)
        return True

    def missing(self, jobs: Iterable[K]) -> list[K]:
        """The jobs without a row."""
        return [job for job in jobs if job.key not in self.rows]

    def ordered(self, jobs: Iterable[Keyed]) -> list[R]:
        """Finished rows in the order of the jobs."""
        return [self.rows[job.key] for job in jobs if job.key in self.rows]

    def write_table(self, rows: Sequence[R]) -> Path:
        """`tasks.csv`: a header with units, a line a run."""
        path = self.folder / TABLE
        write_whole(path, to_csv(rows, self._kind))
        return path

    def close(self) -> None:
        """Close the file of finished rows; never raises, `trouble` tells."""
        if self._stream is not None:
            try:
                self._stream.close()
            except OSError as error:
                self._fail(error)

    def _fail(self, error: OSError) -> None:
        """Go on without the file: half a line at its end is dropped when it is read again."""
        why = error.strerror or error
        self.trouble = f"{self.folder / ROWS}: cannot be written: {why}; such a campaign cannot go on"
        stream, self._stream = self._stream, None
        if stream is not None:
            try:
                stream.close()
            except OSError:
                pass

    def _claim(self, about: dict[str, Any]) -> None:
        path = self.folder / CAMPAIGN
        text = json.dumps(about, indent=1, sort_keys=True) + "\n"
        there = [] if path.exists() else [name for name in _WRITTEN if (self.folder / name).exists()]
        if there:
            raise InputError(
                f"--out {self.folder}: holds {there[0]}, which would be written anew, and no {CAMPAIGN}; "
                "choose another folder"
            )
        if path.exists():
            try:
                found = json.loads(path.read_text(encoding="utf-8"))
            except ValueError:
                found = None
            differs = _difference(found, json.loads(text))
            if differs:
                raise InputError(
                    f"--out {self.folder}: holds another campaign ({differs}); choose another folder"
                )
        write_whole(path, text)

    def _read(self) -> dict[str, R]:
        """Finished rows. A last line that was cut off is dropped, from the file as well; crashes are run again.

        Raises:
            InputError: another line is damaged.
        """
        path = self.folder / ROWS
        if not path.exists():
            return {}
        rows: dict[str, R] = {}
        lines = path.read_bytes().splitlines(keepends=True)
        for number, line in enumerate(lines, 1):
            row = _row(line, self._kind)
            if row is None and number < len(lines):
                raise InputError(
                    f"--out {self.folder}: {ROWS}, line {number}: is no row; take it out to go on"
                )
            if row is None:
                write_whole(path, b"".join(lines[:-1]))
            else:
                (self.crashed if row.error else rows)[row.key] = row
                if not row.error:
                    self.crashed.pop(row.key, None)
        return rows


def _row(line: bytes, kind: type[R]) -> R | None:
    """What a whole line says; None where it is none."""
    if not line.endswith(b"\n"):
        return None
    try:
        return msgspec.json.decode(line, type=kind)
    except (msgspec.MsgspecError, ValueError):
        return None


def source_digest(*shows: str) -> str:
    """Hash of the code, scenarios and arms that decide rows: a campaign must not go on with others.

    Args:
        shows: files and folders of `farhand` that only show rows which are there.
    """
    root = Path(__file__).resolve().parents[2]
    # folder by folder, as those of the sides may be links
    found = [path for folder in root.iterdir() if folder.is_dir() for path in folder.rglob("*.py")]
    files = [path for path in found if not any(map(path.relative_to(root).is_relative_to, shows))]
    files += (root / "scenarios").glob("*.toml")
    files += (root / "robot_side/arm/models").iterdir()
    digest = hashlib.sha256()
    for path in sorted(files):
        digest.update(str(path.relative_to(root)).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def to_csv(rows: Sequence[Any], kind: Any = Row) -> str:
    """CSV text; the same rows give the same bytes.

    Args:
        rows: of one kind; their labels, where they have any, are the first columns.
        kind: of the rows, a msgspec Struct; its `UNITS`, where it has any, go into the header.
    """
    fields = [name for name in kind.__struct_fields__ if name not in ("key", "labels")]
    units = getattr(kind, "UNITS", UNITS)
    labels = list(rows[0].labels) if rows and hasattr(rows[0], "labels") else []
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*labels, *(column(name, units) for name in fields)])
    for row in rows:
        writer.writerow(
            [*(_cell(row.labels[name]) for name in labels), *(_cell(getattr(row, name)) for name in fields)]
        )
    return text.getvalue()


def column(name: str, units: Mapping[str, str] = UNITS) -> str:
    """The name with its unit: `duration [s]`."""
    return f"{name} [{units[name]}]" if name in units else name


def _cell(value: Any) -> Any:
    if value is None:
        return ""
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, list | tuple):
        return json.dumps(value)
    return value


def _difference(found: Any, wanted: dict[str, Any]) -> str:
    """The first setting that differs, in words; empty if none does, which rows are wanted aside."""
    if not isinstance(found, dict):
        return f"{CAMPAIGN} is unreadable"
    for key in sorted({*found, *wanted} - {SELECTION}):
        a, b = found.get(key), wanted.get(key)
        if isinstance(a, dict) and isinstance(b, dict) and a != b:
            return f"{key}: {_difference(a, b)}"
        if a != b:
            return f"{key} was {_short(a)}, now {_short(b)}"
    return ""


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else text[:57] + "..."
