"""The deadline is what was measured: a program that had stopped before it was listened to measures nothing."""

from types import SimpleNamespace

import pytest

from farhand.robot_side.ur.deadline import measured_deadline
from farhand.robot_side.ur.program import BY_DEADLINE, ENDED, HEARD, RUN
from farhand.robot_side.ur.settings import UrSettings


class Clock:
    """Goes on only by sleeping."""

    now = 0

    def now_ns(self):
        return self.now

    def sleep_until(self, instant_ns):
        self.now = max(self.now, instant_ns)


class Link:
    """A controller at 500 Hz whose program stops 0.06 s after the last message.

    Args:
        clock: of the host.
        late: of the first so many starts, those in which the program has stopped while it was spoken to.
    """

    def __init__(self, clock, late):
        self.clock, self.late, self.run = clock, late, 1
        self.number, self.sent_ns = 0, 0
        self.client = SimpleNamespace(fresh=(), rate_hz=500.0)

    def poll(self, now_ns, starts=True):
        ended = self.run <= self.late or (self.number and now_ns - self.sent_ns > 60_000_000)
        values = {
            HEARD: self.number,
            RUN: self.run,
            ENDED: BY_DEADLINE if ended else 0,
            "timestamp": now_ns * 1e-9,
        }
        self.client.fresh = (values,)
        return SimpleNamespace(values=values, trouble="", age=0.0)

    def send(self, speeds, now_ns):
        self.number, self.sent_ns = self.number + 1, now_ns

    def try_again(self):
        self.run, self.number = self.run + 1, 0


@pytest.mark.parametrize("late", [0, 1, 2])
def test_what_ended_before_it_was_listened_to_is_measured_again(late):
    clock = Clock()
    found = measured_deadline(Link(clock, late), UrSettings(), clock)
    assert found.kept
    assert "measured 0.059 s" in found.said  # by samples every 2 ms


def test_a_host_that_is_always_too_late_is_refused_and_no_figure_is_told():
    clock = Clock()
    found = measured_deadline(Link(clock, 9), UrSettings(), clock)
    assert not found.kept
    assert found.said.startswith("not measured, since this host sent too late itself")
