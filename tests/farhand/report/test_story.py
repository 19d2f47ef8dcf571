"""What is read of a recording is what was seen and decided."""

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.common.geometry import norm
from farhand.common.messages.codec import encode
from farhand.common.messages.keys import state_key
from farhand.common.recording.records import RunInfo, TickRecord
from farhand.common.recording.run_file import RunFile
from farhand.report.drawing.charts import clearance
from farhand.report.drawing.thinning import highest, thinned
from farhand.report.reading.evidence import Evidence
from farhand.report.reading.figures import figures_of, lateness, period_of
from farhand.report.reading.margin import additive, coverage, width_of
from farhand.report.reading.story import read_story
from farhand.testing import report, state
from farhand.testing.disk import ScriptedFile

INFO = RunInfo(
    scenario={"name": "x", "controller": {"d_min": 0.05, "period": 0.1}},
    robot="r",
    session=7,
    seed=1,
    versions={},
)
TICK_NS = 100_000_000


def told(reports, states=(), missing=(), info=INFO):
    """The story of a run of these reports, and (tick, state) that arrived."""
    disk = ScriptedFile()
    file = RunFile(None, info, file=disk)
    for number, each in enumerate(reports):
        packets = tuple(
            (state_key("r"), (number + 1) * TICK_NS - 1, encode(s)) for tick, s in states if tick == number
        )
        if number not in missing:
            file.tick(TickRecord(number, (number + 1) * TICK_NS, packets, None, encode(each)))
    file.close()
    return read_story(disk)


def test_every_tick_state_and_message_of_the_network_is_there(recorded):
    path, result = recorded
    story = read_story(path)
    assert story.lacks == []
    assert story.ticks.rows == len(result.reports)
    for name, value in (
        ("inflation", lambda r: r.inflation),
        ("error", lambda r: r.prediction_error),
        ("asked", lambda r: norm(r.desired)),
        ("done", lambda r: norm(r.filtered)),
        ("rtt", lambda r: np.nan if r.rtt is None else r.rtt),
    ):
        assert story.ticks[name] == pytest.approx([value(r) for r in result.reports], nan_ok=True), name
    first = next(n for n, each in enumerate(result.reports) if each.mode == "run")
    assert story.ticks["t"] == pytest.approx((np.arange(len(result.reports)) - first) * 0.1)
    assert (story.zero, story.driven) == (
        "the first motion command",
        pytest.approx(result.summary.duration, abs=0.11),
    )
    assert story.states.rows == result.reports[-1].states
    down = story.network.ways["downlink"]
    assert down.messages == result.network.downlink.received + result.network.downlink.duplicated
    assert dict(down.lost) == result.network.downlink.dropped
    assert story.least == pytest.approx(result.reports[-1].min_clearance)


def test_ticks_that_are_missing_are_told():
    story = told([report(n) for n in range(20)], missing={5, 6, 7})
    assert story.ticks.rows == 17
    assert any(line.startswith("3 ticks are missing 0.4 s after the first one") for line in story.lacks)


def test_lateness_is_measured_against_the_operators_own_rate():
    scenario = INFO.scenario | {"controller": {"period": 0.2}, "operator": {"rate_hz": 12.5}}
    story = told([report(n) for n in range(3)], info=msgspec.structs.replace(INFO, scenario=scenario))
    assert period_of(story) == pytest.approx(0.08)
    assert lateness(story)[1] == pytest.approx([0.02, 0.02])
    scenario["operator"] = {"rate_hz": None}
    assert period_of(told([report(0)], info=msgspec.structs.replace(INFO, scenario=scenario))) == 0.2


@pytest.mark.parametrize(
    ("missing", "zero", "first"),
    [
        ((), "the first motion command", -0.3),
        ((7, 8), "the first motion command", -0.3),
        ((2, 3, 4), "the first tick that is recorded: the first motion command is not", 0.0),
        ((0, 1, 2, 3), "the first tick that is recorded: the first motion command is not", 0.0),
        (range(3, 10), "the first tick: no motion command is recorded", 0.0),
    ],
)
def test_times_count_from_the_first_motion_command_where_it_is_recorded(missing, zero, first):
    reports = [report(n, mode="hold" if n < 3 else "run") for n in range(10)]
    story = told(reports, missing=set(missing))
    assert story.zero == zero
    assert story.ticks["t"][0] == pytest.approx(first)
    assert story.driven == (pytest.approx(0.6) if first else None)
    assert story.whole is not bool(missing) or len(missing) == 7  # of an end that is not there no file knows


def test_a_stop_of_the_robot_and_a_refusal_are_told_with_their_reason():
    states = [
        (2, state(0)),
        (3, state(1, mode="stopped", reason="no command for 1 s", refused={"stale": 2})),
        (4, state(2, mode="stopped", reason="no command for 1 s", refused={"stale": 2})),
        (5, state(3)),
    ]
    story = told([report(n) for n in range(8)], states)
    found = {each.kind: each for each in story.happenings}
    assert found["stop"].words == "the robot stopped: no command for 1 s"
    assert found["refused"].words.startswith("the robot refused 2 commands")
    assert story.since(found["stop"].began_ns) < story.since(found["stop"].seen_ns)


def test_a_state_that_another_overtook_is_no_second_stop():
    stopped = {"mode": "stopped", "reason": "no command for 1 s"}
    arrived = [
        (1, state(0)),
        (3, state(2, **stopped)),
        (3, state(1)),
        (4, state(4, **stopped)),
        (5, state(3)),
    ]
    story = told([report(n) for n in range(8)], arrived)
    assert [each.kind for each in story.happenings] == ["stop"]
    assert story.states["late"].tolist() == [0, 0, 1, 0, 1]
    shown = next(line for line in clearance(story, "").lines if line.label == "tool's sphere")
    assert len(shown.t) == 3


def test_an_intervention_says_for_what_how_much_and_how_near():
    fast, slow = (0.3, 0.0, 0.0), (0.1, 0.0, 0.0)
    reports = [
        report(
            n,
            desired=fast,
            filtered=fast if n < 3 else slow,
            intervening=n >= 3,
            binding="post" if n >= 3 else "",
        )
        for n in range(6)
    ]
    reports[4] = msgspec.structs.replace(reports[4], clearance=0.031, inflation=0.012)
    story = told(reports)
    (found,) = [each for each in story.happenings if each.kind == "filter"]
    assert found.words == (
        "filter slowed the tool for 'post': 0.30 m/s asked, 0.10 m/s done; clearance 31 mm at least, margin up to 12 mm"
    )


def test_waiting_before_the_first_drive_is_no_hold_and_standing_still_afterwards_is():
    reasons = ["no state yet", "", "", "the network is silent", ""]
    reports = [
        report(n, mode="hold" if reason else "run", stop_reason=reason) for n, reason in enumerate(reasons)
    ]
    story = told(reports)
    assert [(each.kind, each.words) for each in story.happenings] == [
        ("wait", "no state yet"),
        ("hold", "the network is silent"),
    ]


def test_standing_still_is_counted_once_where_the_robot_holds_and_zero_is_commanded():
    """2 s of zero for two reasons in turn, and the robot holds from 0.4 s after their beginning to 0.4 s after."""
    reports = [
        report(n, mode="run" if n < 5 or n > 25 else "hold", stop_reason="ab"[n % 2] if 5 <= n <= 25 else "")
        for n in range(40)
    ]
    states = [(n, state(n, mode="hold" if 9 <= n < 29 else "run", reason="c")) for n in range(40)]
    times, seconds = figures_of(Evidence("x", told(reports, states))).happened["hold"]
    assert (times, seconds) == (1, pytest.approx(2.4, abs=0.05))


def test_parts_that_are_alternatives_are_not_added_up():
    parts = [{"floor": 0.01, "innovation": 0.02, "lag": 0.003}, {"floor": 0.01, "innovation": 0.004}]
    story = told(
        [
            report(n, margin_parts=p, inflation=i)
            for n, (p, i) in enumerate(zip(parts, (0.023, 0.01), strict=True))
        ]
    )
    found, largest = additive(story)
    assert largest
    assert sum(found.values()) == pytest.approx(width_of(story))
    assert found["innovation"] == pytest.approx([0.02, 0.0])
    assert found["floor"] == pytest.approx([0.0, 0.01])


def test_an_error_is_held_against_the_margin_before_it():
    rows = [(0.01, 0.0), (0.02, 0.02), (0.02, 0.015), (0.02, 0.0)]  # the second grew by the very error
    story = told([report(n, inflation=m, prediction_error=e, states=1) for n, (m, e) in enumerate(rows)])
    assert coverage(story) == (3, pytest.approx(2 / 3))


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(-1e3, 1e3) | st.just(float("nan")), max_size=400), st.integers(1, 20))
def test_thinning_keeps_least_and_largest_of_every_stretch(values, stretches):
    values = np.array(values, dtype=float)
    t = np.arange(len(values), dtype=float)
    span = (0.0, float(max(1, len(values))))
    rows, peaks = thinned(t, values, span, stretches), highest(t, values, span, stretches)
    assert len(rows) <= 2 * stretches
    assert (np.diff(rows) > 0).all()
    for k in range(stretches):
        inside = (t >= span[1] * k / stretches) & (t < span[1] * (k + 1) / stretches) & np.isfinite(values)
        if inside.any():
            assert values[inside].min() in values[rows]
            assert values[inside].max() in values[rows]
            assert values[inside].max() in values[peaks]
