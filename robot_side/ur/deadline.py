"""How long the controller lets the arm go on when Farhand falls silent: measured at each start, as the arm stands."""

from dataclasses import dataclass

from farhand.common.timing.clock import SystemClock, to_ns
from farhand.robot_side.ur.link import UrLink
from farhand.robot_side.ur.program import (
    BY_DEADLINE,
    ENDED,
    HEARD,
    RUN,
    STANDS_WITHIN,
    WATCHDOG_HZ,
    brake_time,
)
from farhand.robot_side.ur.settings import UrSettings
from farhand.robot_side.ur.states import unready

STARTS_WITHIN = 3.0
SPEAKS_FOR = 0.1
WAITS_FOR = 1.0
STEP = 0.001
"""s."""
ATTEMPTS = 3
"""To measure; a host under load may fall silent by itself."""
ENDED_BEFORE = -1.0


@dataclass(frozen=True, slots=True)
class Deadline:
    """Attributes:
    said: for people.
    kept: whether the arm stands in time, as far as could be measured.
    """

    said: str
    kept: bool = True


def measured_deadline(link: UrLink, settings: UrSettings, clock: SystemClock) -> Deadline:
    """Let the program's deadline pass once, at speed zero.

    Where the arm cannot be driven now there is nothing to be measured; where the controller's watchdog is the deadline
    it would be a protective stop.
    """
    if settings.deadline == "watchdog":
        longest = 2.0 / WATCHDOG_HZ
        least = 1.0 / WATCHDOG_HZ
        return Deadline(
            f"the controller's watchdog, {least:.2f} to {longest:.2f} s after the last message, by a protective stop; "
            "not measured, as it would be one"
        )
    why = _until_ready(link, clock)
    if why:
        return Deadline(f"not measured, since {why}")
    silent: float | None = ENDED_BEFORE
    for _ in range(ATTEMPTS):
        _speak(link, clock)
        silent = _silence(link, clock)
        if silent != ENDED_BEFORE:
            break
        link.try_again()
        _until_ready(link, clock)
    if silent == ENDED_BEFORE:
        return Deadline(
            "not measured, since this host sent too late itself; it is too slow for this", kept=False
        )
    if silent is None:
        return Deadline("the controller's program went on without messages", kept=False)
    link.try_again()
    _until_ready(link, clock)
    stands = silent + brake_time(settings, 1.0 / link.client.rate_hz)
    return Deadline(
        f"the controller's own program, by an ordinary stop: measured {silent:.3f} s from the last message to its "
        f"stop; from any speed the arm stands within {stands:.3f} s",
        kept=stands <= STANDS_WITHIN,
    )


def _until_ready(link: UrLink, clock: SystemClock) -> str:
    end_ns = clock.now_ns() + to_ns(STARTS_WITHIN)
    while True:
        now_ns = clock.now_ns()
        facts = link.poll(now_ns)
        if facts.values and int(facts.values[RUN]) == link.run != 0:
            return ""
        if now_ns > end_ns:
            return unready(facts) or "the program does not start"
        clock.sleep_until(now_ns + to_ns(STEP))


def _speak(link: UrLink, clock: SystemClock) -> None:
    end_ns = clock.now_ns() + to_ns(SPEAKS_FOR)
    while (now_ns := clock.now_ns()) < end_ns:
        link.poll(now_ns, starts=False)
        link.send([0.0] * 6, now_ns)
        clock.sleep_until(now_ns + to_ns(2 * STEP))


def _silence(link: UrLink, clock: SystemClock) -> float | None:
    """How long after the last message the program stopped (s), by the controller's clock; None: it did not.

    ENDED_BEFORE where it was never seen to run: it stopped while it was spoken to, and nothing was measured.
    """
    end_ns = clock.now_ns() + to_ns(WAITS_FOR)
    number, heard = -1, 0.0
    while (now_ns := clock.now_ns()) < end_ns:
        link.poll(now_ns, starts=False)
        for values in link.client.fresh:
            if number == -1 and int(values[ENDED]) == BY_DEADLINE:
                return ENDED_BEFORE
            if int(values[HEARD]) != number:
                number, heard = int(values[HEARD]), float(values["timestamp"])
            if int(values[ENDED]) == BY_DEADLINE:
                return float(values["timestamp"]) - heard
        clock.sleep_until(now_ns + to_ns(STEP))
    return None
