"""What a recording holds.

Topic `tick` holds one MessagePack map per control tick; metadata `run` holds what is needed to run it again, and
metadata `gap` stands before the tick that follows on ticks that could not be written.
"""

import msgspec

FORMAT = "farhand-run-2"  # 1 held messages of schema 3, whose obstacles were spheres only
TOPIC = "tick"
RUN, GAP = "run", "gap"


class RunInfo(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What is needed to run the same again.

    Attributes:
        scenario: as TOML-like nested tables.
        robot: the robot's name.
        session: the operator's session.
        seed: the run's seed.
        versions: of the programs and libraries.
        solver: the solver that was really used.
        operator: the operator's name.
    """

    format: str = FORMAT
    scenario: dict[str, object]
    robot: str
    session: int
    seed: int
    versions: dict[str, str]
    solver: str = ""
    operator: str = "operator"


class TickRecord(msgspec.Struct, frozen=True, array_like=True):
    """One tick.

    Attributes:
        now_ns: its beginning, operator's clock.
        packets: (key, arrived_ns, payload) of all that had arrived.
        command: the bytes sent, None if nothing was.
        report: the encoded ControlReport.
    """

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
    """

    ticks: int
    first_ns: int
    last_ns: int
    why: str
    before: int = 0

    def and_then(self, later: "Gap") -> "Gap":
        """This gap and one that follows on it, as one; why is said of the first."""
        return Gap(
            ticks=self.ticks + later.ticks, first_ns=self.first_ns, last_ns=later.last_ns, why=self.why
        )
