"""Time sources. This is the only file that imports `time`; everything else is told what time it is."""

import random
import time
from datetime import datetime, timedelta, timezone

NANOSECONDS_PER_SECOND = 1_000_000_000


class SystemClock:
    """The monotonic clock of this host, shifted by a random offset of its own.

    It goes on while the host is suspended: what was said before is as old as it is when it wakes.
    The offset makes an accidental comparison of two processes' clocks fail loudly
    instead of working by luck on one host.
    """

    def __init__(self) -> None:
        self._offset_ns = random.SystemRandom().randrange(1 << 40, 1 << 50)

    def now_ns(self) -> int:
        """Current instant in ns."""
        return time.clock_gettime_ns(time.CLOCK_BOOTTIME) + self._offset_ns

    def epoch_ns(self) -> int:
        """What must be added to an instant for the time of day (ns since 1970, UTC); never used for control."""
        return time.time_ns() - self.now_ns()

    def time_of_day_ns(self) -> int:
        """Now (ns since 1970, UTC); never used for control."""
        return time.time_ns()

    def sleep_until(self, deadline_ns: int) -> None:
        """Block until `deadline_ns` (absolute, ns); returns at once when it has passed."""
        remaining = deadline_ns - self.now_ns()
        if remaining > 0:
            time.sleep(remaining / NANOSECONDS_PER_SECOND)


class VirtualClock:
    """A clock that moves only when told to, never backwards."""

    def __init__(self, start_ns: int = 0) -> None:
        self._now_ns = start_ns

    def now_ns(self) -> int:
        """Current virtual instant in ns."""
        return self._now_ns

    def advance_to(self, instant_ns: int) -> None:
        """Set the clock to `instant_ns`; raises ValueError if that lies in the past."""
        if instant_ns < self._now_ns:
            raise ValueError(f"virtual time cannot run backwards: {instant_ns} < {self._now_ns}")
        self._now_ns = instant_ns


def to_ns(seconds: float) -> int:
    """Seconds to integer nanoseconds, rounded to nearest."""
    return round(seconds * NANOSECONDS_PER_SECOND)


def to_seconds(duration_ns: int) -> float:
    """Integer nanoseconds to seconds."""
    return duration_ns / NANOSECONDS_PER_SECOND


def local_timestamp() -> str:
    """Wall-clock time for the names of run folders, such as 20260131-235959; never used for control."""
    return datetime.now().strftime("%Y%m%d-%H%M%S")


def timestamp_in(name: str) -> float | None:
    """The instant of `local_timestamp` that a name begins with (s since 1970, this host's zone); None: it has none."""
    try:
        return datetime.strptime(name[:15], "%Y%m%d-%H%M%S").timestamp()
    except (ValueError, OverflowError):
        return None


def local_words(seconds: float) -> str:
    """Wall-clock time of this host for tables: `2026-01-31 23:59`; takes s since 1970."""
    return datetime.fromtimestamp(seconds).strftime("%Y-%m-%d %H:%M")


def utc_words(epoch_ns: int) -> str:
    """A time of day for people: `2026-01-31 23:59:59 UTC`.

    Args:
        epoch_ns: since 1970 (ns).
    """
    at = datetime(1970, 1, 1, tzinfo=timezone.utc) + timedelta(seconds=epoch_ns // NANOSECONDS_PER_SECOND)
    return at.strftime("%Y-%m-%d %H:%M:%S UTC")


def utc_after(days: float = 0.0) -> datetime:
    """Wall-clock time, UTC, so many days from now; for the validity of certificates, never for control."""
    return datetime.now(timezone.utc) + timedelta(days=days)


def utc_seconds() -> float:
    """Wall-clock time, UTC, in s since 1970; for the validity of certificates, never for control."""
    return time.time()


def stopwatch_seconds() -> float:
    """A high-resolution stopwatch reading in s, for reporting how long a computation took."""
    return time.perf_counter()


def thread_seconds() -> float:
    """Time that this thread has had a processor (s): the same, where others want the processor as well."""
    return time.thread_time()
