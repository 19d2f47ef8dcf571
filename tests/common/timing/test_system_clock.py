"""The clock that ages are counted by."""

from farhand.common.timing import clock as timing
from farhand.common.timing.clock import SystemClock

time = timing.time


def test_it_goes_on_while_the_host_is_suspended(monkeypatch):
    """Linux stops CLOCK_MONOTONIC meanwhile: what was said before would count as fresh after it."""
    clock, suspended = SystemClock(), [0]
    running = time.clock_gettime_ns

    def reads(which):
        return running(which) + (suspended[0] if which == time.CLOCK_BOOTTIME else 0)

    monkeypatch.setattr(time, "clock_gettime_ns", reads)
    before = clock.now_ns()
    suspended[0] = 3600 * 10**9
    assert clock.now_ns() - before >= 3600 * 10**9
