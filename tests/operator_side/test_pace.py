"""Ticks that are a part of a plan's step: counted in seconds, and predicted as the robot plays them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.common.messages.base import ZERO
from farhand.operator_side.margins.trail import Trail
from farhand.operator_side.pace import Pace, is_whole, pace_of
from farhand.operator_side.prediction.command_history import CommandHistory
from farhand.operator_side.prediction.innovations import Innovations
from farhand.operator_side.prediction.law import Known
from farhand.operator_side.prediction.registry import PREDICTORS
from farhand.robot_side.safety.plan import PlanPlayer
from farhand.runs.scenario import Scenario, replace_settings
from farhand.testing import OPERATOR_SESSION, command, state

MS = 1_000_000
STEP_NS = 100 * MS


def scenario(**settings):
    plain = Scenario(name="x", start=ZERO, targets=((1.0, 0.0, 0.0),))
    return replace_settings(plain, {key.replace("__", "."): value for key, value in settings.items()})


def test_a_tick_is_a_step_unless_another_rate_is_asked_for():
    assert pace_of(scenario()) == Pace(0.1, 0.1)
    assert pace_of(scenario(operator__rate_hz=50.0)) == Pace(0.02, 0.1)
    assert pace_of(scenario(operator__rate_hz=50.0)).ticks_a_step == 5
    assert [Pace(tick, 0.1).ticks(3.0) for tick in (0.1, 0.02, 10.0)] == [30, 150, 1]


@pytest.mark.parametrize(("rate", "whole"), [(10, True), (50, True), (30, True), (5, False), (33, False)])
def test_a_step_is_a_whole_number_of_ticks(rate, whole):
    assert is_whole(rate, 0.1) is whole


velocity = st.tuples(*[st.floats(-0.5, 0.5)] * 3)


@settings(max_examples=50)
@given(
    commands=st.lists(st.lists(velocity, min_size=1, max_size=3), min_size=20, max_size=40),
    tick=st.sampled_from([20, 50, 100]),
    held=st.integers(0, 70).map(lambda k: 5 * k),
)
def test_the_timeline_is_what_the_robot_plays(commands, tick, held):
    """Command 0 for `held` ms, as none came; from the next tick on each for its own."""
    history = CommandHistory()
    for seq, plan in enumerate(commands):
        history.add(seq, seq * tick * MS, 0.1, tuple(plan), ZERO)
    last = min(len(commands), held // tick + 1 + 8)
    player, z = PlanPlayer(), [0.0, 0.0, 0.0]
    for ms in range(0, last * tick, 5):
        seq, into = divmod(ms, tick)
        if into == 0 and (seq == 0 or seq > held // tick):
            plan = commands[seq]
            player.load(command(seq, velocity=plan[0], plan=tuple(plan[1:]), plan_period_ns=STEP_NS), ms * MS)
        if ms >= held:
            z = [a + u * 5e-3 for a, u in zip(z, player.twist(ms * MS).linear, strict=True)]
    law = PREDICTORS.get("timeline")(Known(history, OPERATOR_SESSION, tick * 1e-3, 0.0))
    seen = state(applied_session=OPERATOR_SESSION, applied_seq=0, applied_for_ns=held * MS)
    predicted = law.predict(seen, last, last * tick * MS, 0.0)
    if last * tick > held:
        assert predicted.start == pytest.approx(z, abs=1e-9)
        assert predicted.look == pytest.approx((last * tick - held) * 1e-3)


@pytest.mark.parametrize("tick", [20, 100])
def test_a_prediction_that_was_right_is_no_innovation_at_any_rate(tick):
    history = CommandHistory()
    history.add(3, 0, 0.1, ((0.1, 0.0, 0.0), (0.2, 0.0, 0.0)), (1.0, 0.0, 0.0))
    innovations = Innovations(Known(history, OPERATOR_SESSION, tick * 1e-3, 0.0), 100)
    innovations.observe(
        state(
            position=(1.02, 0.0, 0.0),
            applied_session=OPERATOR_SESSION,
            applied_seq=3,
            applied_for_ns=150 * MS,
        )
    )
    assert innovations.largest == pytest.approx(0.0, abs=1e-12)


def test_the_pace_of_a_trail_changes_alike_in_a_second():
    left = []
    for tick in (0.1, 0.02):
        trail = Trail((0.5, 0.5, 0.5), 1.0, tick)
        for _ in range(round(0.5 / tick)):
            trail.learn(np.array([0.5, 0.0, 0.0]), np.zeros(3), 0.1)
        wanted = np.array([0.5, 0.0, 0.0])
        left.append(trail.desired(wanted, np.array([0.1]), np.array([10.0]), np.zeros(1))[0])
    assert left[0] == pytest.approx(left[1])
    assert left[0] == pytest.approx(0.5 / 1.1**5)
