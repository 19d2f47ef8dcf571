"""Lag and acceleration limit, identified from states that a robot of known response sends."""

import math

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.operator_side.prediction.command_history import CommandHistory
from farhand.operator_side.prediction.law import Known
from farhand.operator_side.prediction.response import Identification, Response
from farhand.testing import messages

SESSION, PERIOD, STEP = 7, 0.1, 0.002


def states(lag, acceleration=1e9, seconds=20.0, state_period=0.02, **changes):
    """(history, states) of a robot on a line that is told ±0.3 m/s in turns of 0.5 s, a new command every 0.1 s."""
    history, found = CommandHistory(10_000), []
    velocity = position = 0.0
    steps_a_tick, steps_a_state = round(PERIOD / STEP), round(state_period / STEP)
    for n in range(round(seconds / STEP)):
        seq, held = divmod(n, steps_a_tick)
        wanted = 0.3 if seq % 10 < 5 else -0.3
        if held == 0:
            history.add(seq, 0, PERIOD, ((wanted, 0.0, 0.0),), (0.0, 0.0, 0.0))
        if n % steps_a_state == 0:
            found.append(
                messages.state(
                    session=3,
                    seq=n,
                    t_sample_ns=round(n * STEP * 1e9),
                    position=(position, 0.0, 0.0),
                    velocity=(velocity, 0.0, 0.0),
                    applied_session=SESSION,
                    applied_seq=seq,
                    applied_for_ns=round(held * STEP * 1e9),
                    **({"mode": "run"} | changes),
                )
            )
        for _ in range(20):  # fine enough that its own error is of no account
            rate = (wanted - velocity) / lag
            velocity += STEP / 20 * max(-acceleration, min(acceleration, rate))
        position += velocity * STEP
    return history, found


def identified(history, found, said=0.1):
    identification = Identification(Known(history, SESSION, PERIOD, said))
    for state in found:
        identification.observe(state)
    return identification.estimate()


@pytest.mark.parametrize("lag", [0.03, 0.1, 0.3, 1.0])
def test_the_lag_is_found_whatever_the_robot_says_of_itself(lag):
    found = identified(*states(lag), said=0.5 * lag)
    assert found.lag == pytest.approx(lag, rel=0.1)
    # From one state to the next a short lag and a high limit look much the same.
    assert found.acceleration is None or found.acceleration > 10.0


def test_a_limit_that_binds_is_found_with_the_lag():
    found = identified(*states(0.1, acceleration=1.0))
    assert found.lag == pytest.approx(0.1, rel=0.15)
    assert found.acceleration == pytest.approx(1.0, rel=0.3)


@settings(max_examples=15, deadline=None)
@given(kept=st.lists(st.booleans(), min_size=1000, max_size=1000))
def test_lost_states_take_nothing_from_it(kept):
    history, found = STATES
    estimate = identified(history, [state for state, there in zip(found, kept, strict=True) if there])
    assert estimate.lag is None or estimate.lag == pytest.approx(0.1, rel=0.1)


@pytest.mark.parametrize("changes", [{"mode": "hold"}, {"held_by": "joint 3"}, {"applied_session": 99}])
def test_nothing_is_learnt_from_what_was_not_the_commands_doing(changes):
    if "applied_session" in changes:
        history, found = STATES
        found = [msgspec.structs.replace(state, **changes) for state in found]
    else:
        history, found = states(0.1, **changes)
    assert identified(history, found) == Response()


def test_who_stands_tells_nothing():
    history, found = states(0.1, seconds=0.4)
    still = [state for state in found if math.hypot(*state.velocity) == 0.0]
    assert identified(history, still * 3) == Response()


STATES = states(0.1)
