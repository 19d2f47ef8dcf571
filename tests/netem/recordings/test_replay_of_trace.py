"""Replay by time and by message, the split of round trips, what a gap and the end mean."""

import numpy as np
import pytest

from farhand.common.errors import TraceError
from farhand.netem.recordings.trace import Trace, load_trace

MS = 1_000_000
START = 7_000_000_000


def make(delays, times=None, period=None, kind="one-way", **options):
    times = None if times is None else np.array(times, dtype=float)
    return Trace(np.array(delays, dtype=float), times, period, kind, "", **options)


def draws(trace, milliseconds, direction="uplink"):
    sampler = trace.sampler(direction)
    return [sampler.draw(START + round(instant * MS)) for instant in milliseconds]


def test_the_sample_in_force_since_the_first_message():
    trace = make([0.01, 0.02, 0.03], times=[0, 0.1, 0.2])
    assert draws(trace, [0, 99, 100, 199, 200, 299]) == [0.01, 0.01, 0.02, 0.02, 0.03, 0.03]


def test_one_sample_a_message_without_times():
    assert draws(make([0.01, np.nan, 0.03]), [0, 0, 1000, 1000]) == [0.01, None, 0.03, 0.01]


@pytest.mark.parametrize(("at_end", "expected"), [("wrap", 0.01), ("stop", None), ("hold", 0.02)])
def test_the_end(at_end, expected):
    timed = make([0.01, 0.02], period=0.1, at_end=at_end)
    assert draws(timed, [0, 199, 200, 299]) == [0.01, 0.02, expected, expected]
    assert draws(make([0.01, 0.02], at_end=at_end), [0, 0, 0])[2] == expected


def test_how_it_is_replayed_can_be_said_later():
    trace = make([0.01, 0.02], period=0.1, kind="round-trip")
    other = trace.replayed(at_end="stop", uplink_share=0.25)
    assert draws(other, [0, 200]) == [0.0025, None]
    with pytest.raises(TraceError, match="the uplink's share is 2"):
        trace.replayed(uplink_share=2)
    with pytest.raises(TraceError, match="at_end 'never' is unknown; one of wrap, stop, hold"):
        trace.replayed(at_end="never")


def test_a_wrapped_replay_starts_again_in_phase():
    trace = make([0.01, 0.02, 0.03], period=0.1)
    assert draws(trace, [0, 650, 750, 850])[1:] == [0.01, 0.02, 0.03]


def test_round_trips_are_shared_between_the_directions():
    trace = make([0.1], period=1.0, kind="round-trip", uplink_share=0.3)
    assert draws(trace, [0], "uplink") == [pytest.approx(0.03)]
    assert draws(trace, [0], "downlink") == [pytest.approx(0.07)]
    one_way = make([0.1], period=1.0, uplink_share=0.3)
    assert draws(one_way, [0], "downlink") == [0.1]


def test_a_gap_loses_or_holds_until_the_next_that_arrived():
    samples = {"delays": [0.01, np.nan, np.nan, 0.02], "times": [0, 0.1, 0.2, 0.3]}
    assert draws(make(**samples), [0, 100, 250, 300]) == [0.01, None, None, 0.02]
    held = draws(make(**samples, gap="delay"), [0, 100, 250, 300])
    # All that entered in the gap arrives together, at 320 ms.
    assert held == [0.01, pytest.approx(0.22), pytest.approx(0.07), 0.02]


def test_a_gap_at_the_end_holds_into_the_next_round():
    trace = make([0.01, np.nan], period=0.1, gap="delay")
    assert draws(trace, [0, 150]) == [0.01, pytest.approx(0.06)]


def test_missing_rows_do_not_change_when_the_others_are_in_force(tmp_path):
    path = tmp_path / "t.csv"
    path.write_text("time,delay\n0,1\n0.1,2\n0.2,3\n0.5,4\n0.6,5\n")
    lossy = load_trace(path, unit="ms")
    ignoring = load_trace(path, unit="ms", gap="ignore")
    instants = [0, 150, 250, 310, 450, 510, 650]
    assert draws(lossy, instants) == [0.001, 0.002, 0.003, None, None, 0.004, 0.005]
    assert draws(ignoring, instants) == [0.001, 0.002, 0.003, 0.003, 0.003, 0.004, 0.005]
