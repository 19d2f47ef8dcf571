"""How long the controller lets the arm go on when Farhand falls silent: measured at each start, while the arm stands."""

from farhand.common.timing.clock import SystemClock, to_ns
from farhand.robot_side.ur.link import UrLink
from farhand.robot_side.ur.program import (
    BY_DEADLINE,
    ENDED,
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


def measured_deadline(link: UrLink, settings: UrSettings, clock: SystemClock) -> list[str]:
    """Let the program's deadline pass once, at speed zero; lines for people.

    Where the arm cannot be driven now there is nothing to be measured; where the controller's watchdog is the deadline
    it would be a protective stop.
    """
    if settings.deadline == "watchdog":
        longest = 2.0 / WATCHDOG_HZ
        return [
            f"deadline: the controller's watchdog, {1.0 / WATCHDOG_HZ:.2f} to {longest:.2f} s after the last message, by a "
            "protective stop; not measured, as it would be one"
        ]
    why = _until_ready(link, clock)
    if why:
        return [f"deadline: not measured, since {why}"]
    silent = _silence(link, clock, _speak(link, clock))
    if silent is None:
        return ["deadline: NOT KEPT: the controller's program went on without messages; do not drive"]
    link.try_again()
    _until_ready(link, clock)
    braking = brake_time(settings, 1.0 / link.client.rate_hz)
    return [
        f"deadline: the controller's own program, by an ordinary stop: measured {silent:.3f} s from the last message to "
        f"its stop, then at most {braking:.2f} s of braking; the arm stands within {STANDS_WITHIN:g} s"
    ]


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


def _speak(link: UrLink, clock: SystemClock) -> int:
    """Messages for a while; returns when the last one went (ns)."""
    end_ns = clock.now_ns() + to_ns(SPEAKS_FOR)
    last_ns = clock.now_ns()
    while (now_ns := clock.now_ns()) < end_ns:
        link.poll(now_ns, starts=False)
        link.send([0.0] * 6, now_ns)
        last_ns = now_ns
        clock.sleep_until(now_ns + to_ns(2 * STEP))
    return last_ns


def _silence(link: UrLink, clock: SystemClock, last_ns: int) -> float | None:
    """How long after `last_ns` the program stopped (s); None: it did not."""
    while True:
        now_ns = clock.now_ns()
        facts = link.poll(now_ns, starts=False)
        if int(facts.values[ENDED]) == BY_DEADLINE:
            return (now_ns - last_ns) * 1e-9
        if now_ns - last_ns > to_ns(WAITS_FOR):
            return None
        clock.sleep_until(now_ns + to_ns(STEP))
