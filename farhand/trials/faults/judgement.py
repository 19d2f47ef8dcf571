"""What follows from what the observers saw of one fault. Pure functions of rows and instants."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from farhand.trials.faults.watching import Row

MOVING = 0.02
"""Faster than this is motion (m/s)."""
STANDING_NS = 300_000_000
Stamped = Sequence[tuple[int, Row]]


@dataclass(frozen=True, slots=True)
class Seen:
    """The rows of three observers from the start of a fault on, and the lawful commands since ever.

    Attributes:
        states: on the robot's host.
        commands: on the operator's host.
        reports: on the operator's host.
        known: all commands that the lawful operator's program ever published: (session, seq) -> row.
    """

    states: Stamped
    commands: Stamped
    reports: Stamped
    known: dict[tuple[int, int], Row]


@dataclass(frozen=True, slots=True)
class Outcome:
    """One fault, judged.

    Attributes:
        standing: from its start until the robot stood still, stopped (s); None: it never did, or nobody could see.
        acknowledged: from its end until a fresh acknowledgement was obeyed (s); None: none was needed.
        again: from its end until the robot moved again (s); None: it did not.
        oldest: age of the oldest robot state that an obeyed command was built on when it was obeyed (s).
        sent, lost: commands of the lawful operator.
        states_lost: states of the robot that never reached the operator (one or two are always under way).
        refused: commands that the robot refused, by reason.
        clearance: smallest distance to an obstacle (m).
        unsafe: what was not as it must be, in words; empty: safe.
        arm_stood: from its start until no joint moved, by the arm's own controller (s); None: it moved on, or has none.
    """

    standing: float | None
    acknowledged: float | None
    again: float | None
    oldest: float
    sent: int
    lost: int
    states_lost: int
    refused: dict[str, int]
    clearance: float
    unsafe: tuple[str, ...]
    arm_stood: float | None = None

    @property
    def safe(self) -> bool:
        """Whether all was as it must be."""
        return not self.unsafe


def judge(seen: Seen, begin_ns: int, end_ns: int, max_age: float, tick: float) -> Outcome:
    """What happened from `begin_ns` on; the fault ended at `end_ns`.

    Args:
        seen: what the observers saw.
        begin_ns, end_ns: of the fault.
        max_age: that the robot allows (s).
        tick: of the robot (s).
    """
    oldest, foreign = _oldest(seen)
    again = next(
        (
            (t - end_ns) * 1e-9
            for t, r in seen.states
            if t >= end_ns and r["mode"] == "run" and r["speed"] > MOVING
        ),
        None,
    )
    clearance = min((r["clearance"] for _, r in seen.states), default=0.0)
    sent = sum("command" in r for _, r in seen.commands)
    unsafe = []
    if oldest > max_age + tick:
        unsafe.append(f"a command built on a state {oldest:.2f} s old moved it")
    if foreign:
        unsafe.append(f"commands of session {foreign:x} moved it")
    if not clearance > 0.0:
        unsafe.append("it touched something")
    if _moved_unacknowledged(seen):
        unsafe.append("it left a stop without a fresh acknowledgement")
    if again is None:
        unsafe.append("it did not drive again")
    return Outcome(
        standing=_standing(seen.states, begin_ns),
        acknowledged=_acknowledged(seen, end_ns),
        again=again,
        oldest=oldest,
        sent=sent,
        lost=max(0, sent - increase((r["session"], r["received"]) for _, r in seen.states)),
        states_lost=_states_lost(seen),
        refused={why: count for why, count in _refused(seen.states).items() if count},
        clearance=clearance,
        unsafe=tuple(unsafe),
    )


def increase(counts: Iterable[tuple[int, int]]) -> int:
    """By how much a counter rose; it begins anew at 0 in each session of its owner."""
    total, before = 0, None
    for session, count in counts:
        if before is not None:
            total += count - before[1] if before[0] == session else count
        before = session, count
    return total


def _states_lost(seen: Seen) -> int:
    """States that were sent, but not in the operator's count, between its first and its last report."""
    if not seen.reports:
        return 0
    first_ns, last_ns = seen.reports[0][0], seen.reports[-1][0]
    sent = increase((r["session"], r["state"]) for t, r in seen.states if first_ns <= t <= last_ns)
    return max(0, sent - increase((r["session"], r["states"]) for _, r in seen.reports))


def _oldest(seen: Seen) -> tuple[float, int]:
    """Age of the oldest basis of a command that moved the robot (s), and a session that had no right to."""
    oldest, foreign = 0.0, 0
    sessions = {session for session, _ in seen.known}
    for _, row in seen.states:
        session, seq = row["applied"]
        if not session or row["speed"] <= MOVING:
            continue
        if session not in sessions:
            foreign = session
        command = seen.known.get((session, seq))
        if command is not None and command["echo"] and command["echo"][0] == row["session"]:
            obeyed_ns = row["sample_ns"] - row["applied_for_ns"]
            oldest = max(oldest, (obeyed_ns - command["echo"][1]) * 1e-9)
    return oldest, foreign


def _standing(states: Stamped, begin_ns: int) -> float | None:
    since_ns: int | None = None
    for t_ns, row in states:
        if row["speed"] > MOVING:
            since_ns = None
        elif since_ns is None:
            since_ns = t_ns
        if since_ns is not None and t_ns - since_ns >= STANDING_NS and row["mode"] != "run":
            return (since_ns - begin_ns) * 1e-9
    return None


def _acknowledged(seen: Seen, end_ns: int) -> float | None:
    """From the end of the fault until the first obeyed acknowledgement (s)."""
    for t_ns, row in seen.states:
        command = seen.known.get(tuple(row["applied"]))
        if t_ns >= end_ns and command is not None and command["mode"] == "acknowledge":
            return (t_ns - end_ns) * 1e-9
    return None


def _moved_unacknowledged(seen: Seen) -> bool:
    """Whether the robot ran after a stop though nobody had acknowledged since the stop."""
    stopped_ns: int | None = None
    for t_ns, row in seen.states:
        if row["mode"] in ("stopped", "estop"):
            stopped_ns = stopped_ns or t_ns
        elif row["mode"] == "run" and stopped_ns is not None:
            session, seq = row["applied"]
            asked = (
                r["mode"] == "acknowledge" and r["command"][0] == session and r["command"][1] <= seq
                for t, r in seen.commands
                if "command" in r and t >= stopped_ns
            )
            if not any(asked):
                return True
            stopped_ns = None
    return False


def _refused(states: Stamped) -> dict[str, int]:
    refused: dict[str, int] = {}
    last: Row | None = None
    for _, row in states:
        if last is not None:
            before = last["refused"] if last["session"] == row["session"] else {}
            for why, count in row["refused"].items():
                refused[why] = refused.get(why, 0) + count - before.get(why, 0)
        last = row
    return refused
