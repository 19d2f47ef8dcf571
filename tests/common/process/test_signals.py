import os
import signal

import pytest

from farhand.common.process.signals import stop_event_on_signals

NUMBERS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@pytest.fixture(autouse=True)
def _kept():
    kept = {number: signal.getsignal(number) for number in NUMBERS}
    yield
    for number, handler in kept.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("number", NUMBERS)
def test_all_three_mean_an_orderly_end(number):
    event = stop_event_on_signals()
    assert not event.is_set()
    os.kill(os.getpid(), number)
    assert event.wait(10)


def test_a_program_under_nohup_goes_on():
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    event = stop_event_on_signals()
    os.kill(os.getpid(), signal.SIGHUP)
    assert not event.is_set()
    assert signal.getsignal(signal.SIGHUP) == signal.SIG_IGN
