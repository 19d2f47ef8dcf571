"""What a recording holds.

Topic `tick` holds one MessagePack map per control tick, with all bytes that the operator's side got and sent: enough to
decide everything again. What the messages in it say stands beside it as JSON, and as other programs' views of it.
Metadata `run` holds what is needed to run it again, metadata `gap` stands before the tick that follows on ticks that
are not there.
"""

import zlib
from typing import Literal

import msgspec

PROFILE, FORMAT = "farhand", "farhand-run-3"
"""2 had one topic and no time of day; 1 held messages of schema 3, whose obstacles were spheres only."""
TICK = "/farhand/tick"
RUN, GAP = "run", "gap"


def sealed(info: msgspec.Struct) -> dict[str, str]:
    """A struct as metadata, with a checksum: MCAP has none for it."""
    text = msgspec.json.encode(info).decode()
    return {"info": text, "crc32": f"{zlib.crc32(text.encode()):08x}"}


def unsealed(metadata: dict[str, str]) -> str:
    """The JSON text of it; raises ValueError where it is not what was written."""
    text = metadata.get("info", "")
    if metadata.get("crc32") not in (None, f"{zlib.crc32(text.encode()):08x}"):
        raise ValueError("its checksum is another one")
    return text


class RunInfo(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What is needed to run the same again, and to know what it was.

    Attributes:
        scenario: as TOML-like nested tables.
        robot: the robot's name.
        session: the operator's session.
        seed: the run's seed.
        versions: of the programs and libraries.
        solver: the solver that was really used.
        operator: the operator's name.
        clock: `virtual`, or `real`.
        epoch_ns: what must be added to a stamp of the operator's clock for the time of day (ns since 1970, of the
            operator's host); 0 in virtual time.
        git: of the source that ran, as `git describe` says; empty: not from a repository.
        first_tick: number of the first tick in the file; more than 0 where recording began later.
    """

    format: str = FORMAT
    scenario: dict[str, object]
    robot: str
    session: int
    seed: int
    versions: dict[str, str]
    solver: str = ""
    operator: str = "operator"
    clock: Literal["virtual", "real"] = "virtual"
    epoch_ns: int = 0
    git: str = ""
    first_tick: int = 0

    @property
    def kept(self) -> float | None:
        """What the controller kept from obstacles, without the margin (m); None: the scenario does not say it."""
        return self._number("controller", "d_min")

    @property
    def tick_period(self) -> float | None:
        """Of the operator's ticks (s): a step of a plan, where it has no rate of its own; None: it is not said."""
        rate_hz = self._number("operator", "rate_hz")
        return 1.0 / rate_hz if rate_hz else self._number("controller", "period")

    def _number(self, section: str, key: str) -> float | None:
        table = self.scenario.get(section)
        found = table.get(key) if isinstance(table, dict) else None
        return float(found) if isinstance(found, int | float) else None


class TickRecord(msgspec.Struct, frozen=True, array_like=True):
    """One tick.

    Attributes:
        number: counts the ticks from 0.
        now_ns: its beginning, operator's clock.
        packets: (key, arrived_ns, payload) of all that had arrived.
        command: the bytes sent, None if nothing was.
        report: the encoded ControlReport.
    """

    number: int
    now_ns: int
    packets: tuple[tuple[str, int, bytes], ...]
    command: bytes | None
    report: bytes


class Gap(msgspec.Struct, frozen=True, kw_only=True):
    """Ticks in a row that are missing.

    Attributes:
        ticks: how many.
        first_ns, last_ns: beginnings of the first and the last of them, operator's clock.
        why: in words.
        before: number of ticks in the recording that come before the gap; filled in by the reader.
    after: the tick's own number after which they are missing; -1: the first ones are. As `before`.
    """

    ticks: int
    first_ns: int
    last_ns: int
    why: str
    before: int = 0
    after: int = -1

    @property
    def words(self) -> str:
        """How many are missing, and where, by the numbers that the ticks have."""
        where = f"after tick {self.after}" if self.after >= 0 else "at the beginning"
        return f"{self.ticks} ticks are missing {where}"

    def and_then(self, later: "Gap") -> "Gap":
        """This gap and one that follows on it, as one; why is said of the first."""
        return Gap(
            ticks=self.ticks + later.ticks, first_ns=self.first_ns, last_ns=later.last_ns, why=self.why
        )
