"""Certificates that end while a program runs: said once a day from 30 days before, and when they have ended."""

import threading
from collections.abc import Callable, Iterable

from farhand.common.timing.clock import utc_seconds
from farhand.common.trust.certificate import WARN_DAYS, Member

REPEAT = 86_400.0
LOOK_PERIOD = 10.0


class ExpiryWatch:
    """Says what ends, told the wall-clock time (s since 1970). What it would say at once was said at the start.

    Args:
        members: the certificates; the first is the program's own.
        started: wall-clock time of the program's start.
    """

    def __init__(self, members: Iterable[Member], started: float) -> None:
        self._members = tuple(members)
        self._own = self._members[0].name if self._members else ""
        self._said = {member.name: started for member in self._members if _is_near(member, started)}
        self._ended = {member.name for member in self._members if member.days_left_at(started) <= 0}

    def step(self, now: float) -> list[str]:
        """The lines that are due."""
        lines = []
        for member in self._members:
            if member.days_left_at(now) <= 0:
                if member.name not in self._ended:
                    self._ended.add(member.name)
                    lines.append(self._ended_line(member))
                continue
            self._ended.discard(member.name)  # the clock was put back
            last = self._said.get(member.name)
            if _is_near(member, now) and (last is None or not 0 <= now - last < REPEAT):
                self._said[member.name] = now
                lines.append(ending_line(member, now))
        return lines

    def _ended_line(self, member: Member) -> str:
        name = member.name
        if name == self._own:
            follows = "every link is closed now"
        else:
            follows = "links to it are closed, unless it has a new one; copy that to members/ and restart"
        return f"certificate {name!r} has ended, on {member.end}: {follows}"


def ending_line(member: Member, now: float | None = None) -> str:
    """What is to be said of a certificate near its end; empty while that is far."""
    now = utc_seconds() if now is None else now
    if not _is_near(member, now):
        return ""
    days = max(0.0, member.days_left_at(now))
    left = f"{days:.0f} days" if days >= 2.0 else f"{days * 24.0:.0f} hours"
    left = left if days * 24.0 >= 1.0 else "less than an hour"
    return f"certificate {member.name!r} ends in {left}, on {member.end}"


class ExpiryThread:
    """An ExpiryWatch in a thread of its own, until `close`.

    Args:
        members: the certificates; the first is the program's own.
        say: takes a line, in that thread.
    """

    def __init__(self, members: Iterable[Member], say: Callable[[str], None]) -> None:
        self._watch, self._say, self._ended = ExpiryWatch(members, utc_seconds()), say, threading.Event()
        self._thread = threading.Thread(target=self._run, name="certificate-watch", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End the thread."""
        self._ended.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._ended.wait(LOOK_PERIOD):
            for line in self._watch.step(utc_seconds()):
                self._say(line)


def _is_near(member: Member, now: float) -> bool:
    return member.days_left_at(now) <= WARN_DAYS
