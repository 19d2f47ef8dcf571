"""The judge of faults: it sees each thing that must not happen."""

import pytest

from farhand.trials.faults.judgement import Seen, increase, judge

SECOND = 1_000_000_000
ROBOT, ALICE, EVE = 7, 10, 11
BEGIN, END = 10 * SECOND, 12 * SECOND


def state(t, **changes):
    seconds = t / SECOND
    row = {
        "state": round(seconds * 50), "session": ROBOT, "sample_ns": t, "speed": 0.5, "mode": "run", "reason": "",
        "applied": [ALICE, round(seconds * 10)], "applied_for_ns": 0, "received": round(seconds * 10),
        "refused": {}, "clearance": 0.2, "holder": ALICE,
    }  # fmt: skip
    return t, row | changes


def command(t, **changes):
    row = {"command": [ALICE, round(t / SECOND * 10)], "mode": "run", "echo": [ROBOT, t - SECOND // 20]}
    return t, row | changes


def times(start, end, period=SECOND // 50):
    return range(start, end, period)


@pytest.fixture
def calm():
    """Ten seconds of driving, nothing wrong."""
    states = [state(t) for t in times(BEGIN, 20 * SECOND)]
    commands = [command(t) for t in times(BEGIN, 20 * SECOND, SECOND // 10)]
    reports = [(t, {"session": ALICE, "states": r["state"]}) for t, r in states]
    return states, commands, reports


def judged(states, commands, reports):
    known = {tuple(row["command"]): row for _, row in commands}
    return judge(Seen(states, commands, reports, known), BEGIN, END, 1.0, 0.02)


def test_calm_driving_is_safe_and_nothing_is_lost(calm):
    outcome = judged(*calm)
    assert outcome.safe
    assert outcome.standing is None
    assert outcome.acknowledged is None
    assert outcome.again == pytest.approx(0.0, abs=0.03)
    assert (outcome.lost, outcome.states_lost, outcome.refused) == (0, 0, {})
    assert outcome.oldest == pytest.approx(0.05, abs=0.1)


def broken(calm, change):
    states, commands, reports = calm
    return judged([(t, change(t, row)) for t, row in states], commands, reports)


def test_an_old_basis_is_seen(calm):
    states, commands, reports = calm
    old = [(t, row | {"echo": [ROBOT, t - 2 * SECOND]}) for t, row in commands]
    outcome = judged(states, old, reports)
    assert not outcome.safe
    assert "built on a state 2" in outcome.unsafe[0]


def test_a_foreign_session_is_seen(calm):
    outcome = broken(calm, lambda t, r: r | ({"applied": [EVE, 1]} if t > 15 * SECOND else {}))
    assert outcome.unsafe == ("commands of session b moved it",)


def test_an_idle_foreign_session_moves_nothing(calm):
    outcome = broken(calm, lambda t, r: r | ({"applied": [EVE, 1], "speed": 0.0} if t < 11 * SECOND else {}))
    assert outcome.safe


def test_a_touch_is_seen(calm):
    assert (
        "touched"
        in broken(calm, lambda t, r: r | ({"clearance": -0.01} if t > 15 * SECOND else {})).unsafe[0]
    )


def test_a_robot_that_never_moves_again_is_seen(calm):
    outcome = broken(calm, lambda t, r: r | ({"mode": "stopped", "speed": 0.0} if t > 11 * SECOND else {}))
    assert outcome.unsafe == ("it did not drive again",)
    assert outcome.standing == pytest.approx(1.0, abs=0.03)


def stop_between(t, row):
    return row | ({"mode": "stopped", "speed": 0.0} if 11 * SECOND < t < 13 * SECOND else {})


def test_a_stop_wants_an_acknowledgement(calm):
    assert broken(calm, stop_between).unsafe == ("it left a stop without a fresh acknowledgement",)
    states, commands, reports = calm
    states = [(t, stop_between(t, row)) for t, row in states]
    fresh = [command(t, mode="acknowledge") if t == 12.5 * SECOND else (t, row) for t, row in commands]
    assert judged(states, fresh, reports).safe
    before = [command(t, mode="acknowledge") if t == 10.5 * SECOND else (t, row) for t, row in commands]
    assert not judged(states, before, reports).safe


def test_losses_and_refusals_are_counted_across_restarts(calm):
    states, commands, reports = calm

    def restarted(t, row):
        if t < 15 * SECOND:
            return row | {"refused": {"stale": 3}}
        since = (t - 15 * SECOND) / SECOND
        changes = {
            "session": 8,
            "state": round(since * 50),
            "received": max(0, round((since - 2.0) * 10)),
            "refused": {"stale": 2},
        }
        return row | changes

    counted = [(t, {"session": ALICE, "states": r["states"] if t < 12 * SECOND else 600}) for t, r in reports]
    outcome = judged([(t, restarted(t, row)) for t, row in states], commands, counted)
    assert outcome.refused == {"stale": 2}
    assert outcome.lost == 20
    assert outcome.states_lost == 398  # 249 sent before the restart and as many after it, 100 arrived


def test_a_counter_that_begins_anew():
    assert increase([(1, 5), (1, 9), (2, 3), (2, 4)]) == 8
    assert increase([]) == 0
