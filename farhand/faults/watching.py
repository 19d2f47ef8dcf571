"""What the observers saw of one fault, and what follows from it."""

import bisect
import json
import threading
from dataclasses import dataclass
from typing import IO, Any

from common.clock import SystemClock

MOVING = 0.02
STANDING_NS = 300_000_000


class Watcher:
    """Reads an observer's lines in a thread and stamps their arrival."""

    def __init__(self, pipe: IO[str], clock: SystemClock) -> None:
        self.rows: list[tuple[int, dict[str, Any]]] = []
        self._clock = clock
        threading.Thread(target=self._read, args=(pipe,), daemon=True).start()

    def since(self, start_ns: int) -> list[tuple[int, dict[str, Any]]]:
        """Rows that arrived at `start_ns` or later."""
        rows = self.rows
        return rows[bisect.bisect_left(rows, start_ns, key=lambda row: row[0]) :]

    def _read(self, pipe: IO[str]) -> None:
        try:
            for line in pipe:
                self.rows.append((self._clock.now_ns(), json.loads(line)))
        except ValueError:
            return  # closed at the end


@dataclass(frozen=True, slots=True)
class Outcome:
    """One row of the table.

    Attributes:
        name: of the fault.
        standing: from its start until the robot stood still (s); None: it never did, or nobody could see.
        again: from its end until it moved again, on new commands (s); None: it did not.
        oldest: age of the oldest robot state that a command was built on when it was obeyed (s).
        sent, obeyed, refused: commands.
        clearance: smallest distance to an obstacle (m).
        safe: nothing stale was obeyed, nothing was hit, and it drove again.
    """

    name: str
    standing: float | None
    again: float | None
    oldest: float
    sent: int
    obeyed: int
    refused: dict[str, int]
    clearance: float
    safe: bool


def judge(
    name: str, states: Watcher, commands: Watcher, begin_ns: int, end_ns: int, max_age: float, tick: float
) -> Outcome:
    """What happened from `begin_ns` on; the fault ended at `end_ns`."""
    seen = states.since(begin_ns)
    echoes = {tuple(r["command"]): r["echo"] for _, r in commands.rows if "command" in r}
    oldest, obeyed, refused = 0.0, set(), dict[str, int]()
    last: dict[str, int] | None = None
    session = 0
    for _, row in seen:
        key = tuple(row["applied"])
        echo = echoes.get(key)
        if key[0] and echo and echo[0] == row["session"]:
            obeyed.add(key)
            if row["speed"] > MOVING:
                oldest = max(oldest, (row["sample_ns"] - row["applied_for_ns"] - echo[1]) * 1e-9)
        if last is not None and row["session"] == session:
            for why, count in row["refused"].items():
                refused[why] = refused.get(why, 0) + count - last.get(why, 0)
        last, session = row["refused"], row["session"]
    standing = _standing(seen, begin_ns)
    again = next(
        ((t - end_ns) * 1e-9 for t, r in seen if t >= end_ns and r["mode"] == "run" and r["speed"] > MOVING),
        None,
    )
    clearance = min((r["clearance"] for _, r in seen), default=0.0)
    sent = sum("command" in r for _, r in commands.since(begin_ns))
    safe = oldest <= max_age + tick and clearance > 0.0 and again is not None
    shown = {why: count for why, count in refused.items() if count}
    return Outcome(name, standing, again, oldest, sent, len(obeyed), shown, clearance, safe)


def _standing(seen: list[tuple[int, dict[str, Any]]], begin_ns: int) -> float | None:
    since_ns: int | None = None
    for t_ns, row in seen:
        if row["speed"] > MOVING:
            since_ns = None
        elif since_ns is None:
            since_ns = t_ns
        if since_ns is not None and t_ns - since_ns >= STANDING_NS and row["mode"] != "run":
            return (since_ns - begin_ns) * 1e-9
    return None
