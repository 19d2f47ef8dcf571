"""An event that may be set wherever its own thread is."""

import subprocess
import sys
import threading

import pytest

from farhand.common.process.stop_event import StopEvent

SET_WITHIN_WAIT = """
import sys, threading
from farhand.common.process.stop_event import StopEvent

for line in range(1, 60):
    event, left = StopEvent(), [line]
    def handler(frame, what, _):
        left[0] -= what == "line"
        if left[0] == 0:
            event.set()
        return handler
    sys.settrace(handler)
    event.wait(0.002)
    sys.settrace(None)
    event.set()
    assert event.wait(0.0) and event.wait()
"""


def test_a_handler_may_set_it_at_any_line_of_a_wait():
    """As a signal's handler does, which runs between any two lines of the main thread."""
    subprocess.run([sys.executable, "-c", SET_WITHIN_WAIT], timeout=30, check=True)


def test_it_wakes_all_who_wait_and_can_be_taken_back():
    event, woken = StopEvent(), []
    threads = [threading.Thread(target=lambda: woken.append(event.wait(30.0))) for _ in range(3)]
    for thread in threads:
        thread.start()
    event.set()
    for thread in threads:
        thread.join(30.0)
    assert woken == [True] * 3
    event.clear()
    assert not event.is_set()
    assert not event.wait(0.001)


@pytest.mark.parametrize("timeout", [0.0, -1.0, 0.01])
def test_a_wait_that_ends_says_that_it_was_not_set(timeout):
    assert StopEvent().wait(timeout) is False
