"""The watchdog's single rules, each in its plainest case."""

import pytest

from farhand.common.geometry import STILL
from farhand.common.messages.base import ZERO, Echo
from farhand.robot_side.safety.plan import PlanPlayer
from farhand.robot_side.safety.settings import SafetySettings
from farhand.robot_side.safety.watchdog import Watchdog
from farhand.testing import messages

ROBOT = 1234
MS = 1_000_000
START = 5_000 * MS
V = (0.1, 0.0, 0.0)


def command(seq, mode="run", *, now=START, age_ms=20, echo=True, velocity=V, **fields):
    """A command that was built on a state sent `age_ms` before `now`."""
    basis = Echo(ROBOT, 0, now - age_ms * MS, 0) if echo else None
    return messages.command(seq, mode, velocity=velocity, echo=basis, **fields)


@pytest.fixture
def watchdog():
    return Watchdog(SafetySettings(), ROBOT)


def test_waits_forever_for_its_first_operator(watchdog):
    watchdog.tick(START)
    watchdog.tick(START + 3600_000 * MS)
    assert (watchdog.mode, watchdog.reason) == ("hold", "waiting for an operator")


def test_plan_is_played_by_the_index_rule():
    player = PlanPlayer()
    plan = ((2.0, 0.0, 0.0), (3.0, 0.0, 0.0))
    player.load(command(0, velocity=(1.0, 0.0, 0.0), plan=plan), START)
    played = [player.twist(START + h * MS).linear[0] for h in (0, 99, 100, 199, 200, 299, 300, 5000)]
    assert played == [1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 0.0, 0.0]


def test_the_turning_is_played_beside_the_plan_and_ends_with_it():
    player = PlanPlayer()
    plan, turns = ((2.0, 0.0, 0.0), (3.0, 0.0, 0.0)), ((0.0, 0.0, 0.2), (0.0, 0.0, 0.3), (0.0, 0.0, 0.4))
    given = command(0, velocity=(1.0, 0.0, 0.0), angular=(0.0, 0.0, 0.1), plan=plan, plan_angular=turns)
    player.load(given, START)
    played = [player.twist(START + h * MS).angular[2] for h in (0, 99, 100, 200, 299, 300, 5000)]
    assert played == [0.1, 0.1, 0.2, 0.3, 0.3, 0.0, 0.0]
    player.load(command(1, plan=plan, plan_angular=turns[:1]), START)
    assert [player.twist(START + h * MS).angular[2] for h in (0, 100, 200, 300)] == [0.0, 0.2, 0.0, 0.0]
    player.clear()
    assert player.twist(START + 100 * MS) == STILL


def test_silence_plays_the_plan_out_then_stops(watchdog):
    plan = tuple((0.1 * j, 0.0, 0.0) for j in range(2, 20))
    assert watchdog.receive(command(1, plan=plan), START)
    watchdog.tick(START + 300 * MS)
    assert watchdog.mode == "run"
    watchdog.tick(START + 301 * MS)
    assert watchdog.mode == "hold"
    assert watchdog.holds == 1
    assert watchdog.twist(START + 450 * MS).linear == plan[3]
    watchdog.tick(START + 1501 * MS)
    assert (watchdog.mode, watchdog.stops) == ("stopped", 1)
    assert watchdog.twist(START + 1501 * MS).linear == ZERO
    later = START + 1600 * MS
    assert not watchdog.receive(command(2, now=later), later)
    assert watchdog.refused["stopped"] == 1
    assert watchdog.receive(command(3, "acknowledge", now=later), later)
    assert watchdog.twist(later).linear == ZERO
    assert watchdog.receive(command(4, now=later), later)
    assert watchdog.mode == "run"


def test_what_silence_stopped_may_step_aside_for_a_while_and_then_stands(watchdog):
    watchdog.receive(command(1), START)
    watchdog.tick(START + 400 * MS)
    stopped = START + 1501 * MS
    watchdog.tick(stopped)
    assert watchdog.mode == "stopped"
    assert not watchdog.stands(stopped + 9999 * MS)
    assert not watchdog.stands(stopped + 10_000 * MS, lambda: True)  # something comes
    assert watchdog.stands(stopped + 11_000 * MS, lambda: False)
    assert watchdog.stands(stopped + 12_000 * MS, lambda: True)  # for good
    assert watchdog.twist(stopped).linear == ZERO
    watchdog.fault("it broke", stopped + 5000 * MS)
    assert watchdog.stands(stopped + 5000 * MS)


@pytest.mark.parametrize("stop", ["fault", "block", "estop"])
def test_any_other_stop_stands_at_once(watchdog, stop):
    watchdog.receive(command(1), START)
    if stop == "estop":
        watchdog.receive(command(2, "estop"), START)
    else:
        getattr(watchdog, stop)("it says so", START)
    assert watchdog.latched
    assert watchdog.stands(START)


def test_hold_recovers_by_itself(watchdog):
    watchdog.receive(command(1), START)
    later = START + 400 * MS
    watchdog.tick(later)
    assert watchdog.mode == "hold"
    assert watchdog.receive(command(2, now=later), later)
    assert watchdog.mode == "run"
    assert watchdog.stops == 0


def test_holding_operator_is_alive(watchdog):
    watchdog.receive(command(1), START)
    for k in range(100):
        now = START + 100 * k * MS
        assert watchdog.receive(command(2 + k, "hold", now=now, echo=False), now)
        watchdog.tick(now + 99 * MS)
        assert watchdog.mode == "hold"
        assert watchdog.twist(now).linear == ZERO


@pytest.mark.parametrize(
    ("bad", "reason"),
    [
        (command(2, age_ms=1001), "stale"),
        (command(2, age_ms=-1), "stale"),
        (command(1), "old-seq"),
        (command(0), "old-seq"),
        (command(2, echo=False), "no-echo"),
        (command(2, session=8), "foreign-session"),
        (command(2, velocity=(0.0, -2.01, 0.0)), "too-fast"),
        (command(2, plan=((0.0, 0.0, 2.01),)), "too-fast"),
        (command(2, angular=(1.5, 0.0, -1.5)), "turns-too-fast"),
        (command(2, plan_angular=(ZERO, (0.0, 2.01, 0.0))), "turns-too-fast"),
        (command(2, "acknowledge", age_ms=1001), "stale"),
        (command(2, "release", session=8), "late-release"),
    ],
)
def test_refusal_is_counted_and_moves_nothing(watchdog, bad, reason):
    watchdog.receive(command(1), START)
    assert not watchdog.receive(bad, START)
    assert watchdog.refused == {reason: 1}
    assert watchdog.twist(START).linear == V
    assert (watchdog.applied_session, watchdog.applied_seq) == (7, 1)


def test_echo_of_an_earlier_robot_session_is_refused(watchdog):
    bad = messages.command(1, echo=Echo(ROBOT - 1, 0, START, 0))
    assert not watchdog.receive(bad, START)
    assert watchdog.refused == {"foreign-echo": 1}
    assert watchdog.lease.holder == 0
    assert watchdog.receive(command(1), START)


def test_estop_latches_from_anyone_and_only_the_holder_leads_out(watchdog):
    watchdog.receive(command(1), START)
    assert watchdog.receive(command(0, "estop", session=99, echo=False), START)
    assert watchdog.mode == "estop"
    assert not watchdog.receive(command(1, "acknowledge", session=99), START)
    assert watchdog.mode == "estop"
    assert not watchdog.receive(command(2), START)
    assert watchdog.receive(command(3, "acknowledge", age_ms=0), START)
    assert watchdog.mode == "hold"


def test_what_comes_into_a_stop_is_cleared_by_no_acknowledgement_that_has_not_seen_it(watchdog):
    """Another's emergency stop, or a fault, while the holder already acknowledges."""
    watchdog.receive(command(1), START)
    for seq, (deed, reason) in enumerate(
        [
            (
                lambda at: watchdog.receive(command(0, "estop", session=98, source="alice", echo=False), at),
                "by alice",
            ),
            (
                lambda at: watchdog.receive(command(0, "estop", session=99, source="bob", echo=False), at),
                "by bob, and",
            ),
            (lambda at: watchdog.fault("it broke", at), "before; fault: it broke"),
        ]
    ):
        at = START + (100 + 200 * seq) * MS
        deed(at)
        assert watchdog.mode == "estop"
        assert reason in watchdog.reason
        late = command(10 + seq, "acknowledge", now=at - MS)
        assert not watchdog.receive(late, at + 50 * MS)
    assert watchdog.refused["unseen-stop"] == 3
    assert watchdog.receive(command(20, "acknowledge", now=at + 60 * MS), at + 100 * MS)
    assert watchdog.mode == "hold"


def test_no_reason_of_a_stop_is_lost_and_each_anew_is_to_be_seen(watchdog):
    watchdog.receive(command(1), START)
    watchdog.receive(command(0, "estop", session=98, source="bob", echo=False), START)
    watchdog.fault("it broke", START + MS)
    watchdog.receive(command(0, "estop", session=99, source="eve", echo=False), START + 2 * MS)
    watchdog.block("power off", START + 3 * MS)
    assert watchdog.reason == "emergency stop by eve, and by 1 before; fault: it broke; power off"
    now = START + 3000 * MS
    watchdog.receive(command(0, "estop", session=98, source="bob", echo=False), now)  # once more, long after
    assert not watchdog.receive(command(2, "acknowledge", now=now - MS), now + 50 * MS)
    assert watchdog.receive(command(3, "acknowledge", now=now + 40 * MS), now + 100 * MS)
    watchdog.block("power off", now + 200 * MS)
    assert watchdog.reason == "power off"
    watchdog.fault("it broke again", now + 300 * MS)
    assert watchdog.reason == "fault: it broke again; power off"


def test_of_more_senders_than_are_told_apart_each_stop_is_new(watchdog):
    watchdog.receive(command(1), START)
    for n in range(70):
        watchdog.receive(command(0, "estop", session=100 + n, echo=False), START + n * MS)
    assert not watchdog.receive(command(2, "acknowledge", now=START + 69 * MS), START + 80 * MS)
    assert watchdog.receive(command(3, "acknowledge", now=START + 95 * MS), START + 100 * MS)


def test_what_its_holder_sent_before_its_emergency_stop_clears_none(watchdog):
    watchdog.receive(command(1), START)
    watchdog.receive(command(9, "estop"), START + MS)
    assert not watchdog.receive(command(8, "acknowledge", now=START + 2 * MS), START + 3 * MS)
    assert watchdog.refused["old-seq"] == 1


@pytest.mark.parametrize("how", ["fault", "estop"])
def test_an_acknowledgement_clears_only_a_stop_that_its_sender_has_seen(watchdog, how):
    """It may be under way for as long as the network likes, or be the answer to an earlier stop."""

    def stop(now):
        if how == "fault":
            watchdog.fault("it broke", now)
        else:
            watchdog.receive(command(0, "estop", session=99, echo=False), now)

    watchdog.receive(command(1), START)
    stop(START)
    later = START + 100 * MS
    assert not watchdog.receive(command(2, "acknowledge", now=later, age_ms=101), later)
    assert watchdog.latched
    assert watchdog.refused == {"unseen-stop": 1}
    stop(later)  # the same stop again is not another one
    assert watchdog.receive(command(3, "acknowledge", now=later, age_ms=100), later)
    stop(later)
    assert not watchdog.receive(command(4, "acknowledge", now=later, age_ms=100), later)
    assert watchdog.latched


def test_a_release_that_comes_late_is_called_what_it_is(watchdog):
    watchdog.receive(command(1), START)
    assert watchdog.receive(command(2, "release"), START)
    assert not watchdog.receive(command(3, "release", age_ms=0), START)
    assert watchdog.receive(command(1, "hold", session=8, age_ms=0), START)
    assert not watchdog.receive(command(4, "release", age_ms=0), START)
    assert watchdog.refused == {"late-release": 2}


def test_handover_is_explicit_and_old_commands_stay_dead(watchdog):
    watchdog.receive(command(1), START)
    assert not watchdog.receive(command(1, "acknowledge", session=8), START)
    assert watchdog.refused == {"held": 1}
    assert watchdog.receive(command(2, "release"), START)
    assert watchdog.reason == "control was released"
    assert not watchdog.receive(command(2, "acknowledge", session=8), START)  # it cannot have known
    assert watchdog.receive(command(3, "acknowledge", session=8, age_ms=0), START)
    assert (watchdog.lease.holder, watchdog.lease.holder_name) == (8, "operator")
    watchdog.receive(command(4, "release", session=8), START)
    assert not watchdog.receive(command(1), START)  # a replay of what session 7 once sent
    assert watchdog.refused["old-seq"] == 1


def test_silent_holder_loses_control(watchdog):
    watchdog.receive(command(1), START)
    gone = START + 2001 * MS
    watchdog.tick(gone)
    assert (watchdog.lease.holder, watchdog.mode) == (0, "stopped")
    assert watchdog.lease.end == "silent"
    assert not watchdog.receive(command(1, "acknowledge", session=8, now=gone, age_ms=1), gone)
    assert watchdog.refused == {"held": 1}
    assert watchdog.receive(command(2, "acknowledge", session=8, now=gone, age_ms=0), gone)
    assert (watchdog.lease.holder, watchdog.mode) == (8, "hold")


def test_lease_shorter_than_the_timeouts_ends_motion():
    watchdog = Watchdog(SafetySettings(lease_timeout=0.1), ROBOT)
    watchdog.receive(command(1, plan=(V,) * 20), START)
    watchdog.tick(START + 101 * MS)
    assert watchdog.mode == "hold"
    assert watchdog.twist(START + 150 * MS).linear == ZERO


def test_stale_grant_is_no_grant(watchdog):
    assert not watchdog.receive(command(1, "acknowledge", age_ms=1500), START)
    assert not watchdog.receive(command(2, "hold", echo=False), START)
    assert watchdog.lease.holder == 0


def waiting(watchdog, now=START):
    return watchdog.lease.waiting(now)


def test_who_asks_is_remembered_for_three_seconds_and_only_if_the_request_is_fresh(watchdog):
    watchdog.receive(command(1), START)
    for bad in (
        command(5, "acknowledge", session=8, age_ms=1001),
        command(5, "acknowledge", session=8, echo=False),
    ):
        assert not watchdog.receive(bad, START)
    assert waiting(watchdog) == ()
    assert not watchdog.receive(command(5, "acknowledge", session=8, source="bob"), START)
    assert not watchdog.receive(command(5, "acknowledge", session=8, source="mallory"), START)
    assert watchdog.refused == {"stale": 1, "no-echo": 1, "held": 1, "old-seq": 1}
    assert waiting(watchdog, START + 3000 * MS) == ((8, "bob"),)
    assert waiting(watchdog, START + 3001 * MS) == ()
    assert watchdog.lease.holder == 7


def test_the_newest_four_that_ask_are_remembered(watchdog):
    watchdog.receive(command(1), START)
    for session in (11, 12, 13, 11, 14, 15):
        watchdog.receive(command(session + len(watchdog.refused), "acknowledge", session=session), START)
        watchdog.refused[f"{session}"] += 1
    assert [session for session, _ in waiting(watchdog)] == [13, 11, 14, 15]


@pytest.fixture
def asked(watchdog):
    """Session 7 runs, and session 8, bob, waits."""
    watchdog.receive(command(1), START)
    watchdog.receive(command(1, "acknowledge", session=8, source="bob"), START)
    watchdog.refused.clear()
    return watchdog


def test_a_handover_rests_and_only_the_successor_has_control(asked):
    assert asked.receive(command(2, "release", successor=8), START)
    assert (asked.lease.holder, asked.lease.holder_name, waiting(asked)) == (8, "bob", ())
    assert (asked.mode, asked.reason, asked.twist(START).linear) == (
        "hold",
        "control was handed over to bob",
        ZERO,
    )
    assert not asked.receive(command(3, age_ms=0), START)
    assert not asked.receive(command(1, "acknowledge", session=9, age_ms=0), START)
    assert asked.refused == {"foreign-session": 1, "held": 1}
    assert asked.receive(command(2, session=8, age_ms=0), START)
    assert (asked.mode, asked.twist(START).linear) == ("run", V)


def test_a_successor_that_is_never_heard_loses_control_by_itself(asked):
    asked.receive(command(2, "release", successor=8), START)
    asked.tick(START + 2000 * MS)
    assert asked.lease.holder == 8
    asked.tick(START + 2001 * MS)
    assert (asked.lease.holder, asked.lease.holder_name, asked.lease.end) == (0, "", "silent")
    assert (asked.mode, asked.reason) == ("hold", "the holder of control fell silent")


@pytest.mark.parametrize(
    ("bad", "reason"),
    [
        (command(2, "release", successor=9), "no-successor"),
        (command(2, "release", successor=7), "no-successor"),
        (command(2, "release", successor=8, age_ms=1001), "stale"),
        (command(2, "release", successor=8, echo=False), "no-echo"),
        (command(2, "release", successor=9, session=8), "late-release"),
    ],
)
def test_a_handover_that_is_none_leaves_control_where_it_is(asked, bad, reason):
    assert not asked.receive(bad, START)
    assert asked.refused == {reason: 1}
    assert (asked.lease.holder, asked.twist(START).linear) == (7, V)


def test_a_request_under_way_clears_no_stop_for_the_successor(asked):
    asked.fault("it broke", START)
    under_way = command(2, "acknowledge", session=8)
    assert asked.receive(command(2, "release", successor=8), START)
    assert not asked.receive(under_way, START)
    assert (asked.mode, asked.lease.holder, asked.refused) == ("stopped", 8, {"held": 1})
    assert asked.receive(command(3, "acknowledge", session=8, age_ms=0), START)
    assert asked.mode == "hold"


def test_no_delay_ends_a_lease_since_every_command_renews_it_however_old(watchdog):
    watchdog.receive(command(1), START)
    for k in range(1, 100):
        now = START + 100 * k * MS
        watchdog.tick(now)
        assert not watchdog.receive(command(1 + k, now=now, age_ms=5000), now)
    assert (watchdog.lease.holder, watchdog.refused) == (7, {"stale": 99})
