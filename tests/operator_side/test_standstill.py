"""A robot that makes no progress for 3 s: what holds it is named, and nothing is said of one that moves."""

import pytest

from farhand.operator_side.sensing.standstill import Attempt, Standstill
from farhand.testing import state

TICK_NS = 100_000_000
WANT = (0.2, 0.0, 0.0)
ZERO = (0.0, 0.0, 0.0)


def run(ticks=60, moves=0.0, **given):
    """What is said tick by tick; the robot moves at `moves` m/s."""
    fields = {"mode": "run", "reason": "", "desired": WANT, "sent": ZERO, "binding": ""} | given
    held_by, age_ns = fields.pop("held_by", None), fields.pop("age_ns", 0)
    standstill, said = Standstill(), []
    for k in range(ticks):
        own = {"position": (moves * k * 0.1, 0.0, 0.0)} | ({"held_by": held_by} if held_by else {})
        now = {n: v[k] if isinstance(v, list) else v for n, v in fields.items()}
        said.append(standstill.step(Attempt(k * TICK_NS, **now), state(k, **own), age_ns))
    return said


@pytest.mark.parametrize(
    ("given", "what"),
    [
        ({"binding": "ball"}, "obstacle 'ball'"),
        ({"binding": ["ball"] * 10 + [""] * 50}, "obstacle 'ball'"),
        ({"sent": WANT, "held_by": "the edge of its reach"}, "the robot: the edge of its reach"),
        (
            {"sent": WANT, "held_by": "joint limit of elbow_joint", "binding": "ball"},
            "the robot: joint limit",
        ),
        (
            {"binding": "ball", "free_side": "left"},
            "obstacle 'ball'; the way round is free to the left",
        ),
        ({"binding": "ball", "free_side": "above"}, "obstacle 'ball'; the way round is free above"),
        (
            {"sent": WANT, "guarded": "forearm off 'post'"},
            "the robot's guard, which keeps forearm off 'post'",
        ),
        ({"reason": "no plan"}, "no plan"),
        ({"sent": WANT}, "the robot, which does not follow"),
        ({}, "the filter, without an obstacle"),
    ],
)
def test_what_holds_it_is_named_after_three_seconds(given, what):
    said = run(**given)
    assert set(said[:30]) == {""}
    assert all(line.startswith(what) for line in said[30:])


@pytest.mark.parametrize(
    "given",
    [
        {"moves": 0.2, "sent": WANT},
        {"moves": 0.03, "binding": "ball"},
        {"desired": ZERO},
        {"desired": (0.003, 0.0, 0.0)},
        {"mode": "hold"},
        {"age_ns": 1_100_000_000},
    ],
)
def test_of_what_moves_stands_on_purpose_or_is_not_seen_nothing_is_said(given):
    assert set(run(**given)) == {""}


def test_it_begins_anew_after_a_stop():
    said = run(ticks=100, mode=["run"] * 40 + ["hold"] + ["run"] * 59, binding="ball")
    assert said[39]
    assert set(said[40:71]) == {""}
    assert said[75]


def test_who_turns_back_at_a_target_makes_progress_though_it_is_where_it_was():
    standstill = Standstill()
    for k in range(60):
        back = k >= 30
        x = 0.15 * 0.1 * (k if not back else 60 - k)
        wish = (-0.5, 0.0, 0.0) if back else (0.15, 0.0, 0.0)
        attempt = Attempt(k * TICK_NS, "run", "", wish, wish, "")
        assert standstill.step(attempt, state(k, position=(x, 0.0, 0.0)), 0) == ""


def test_who_goes_to_and_fro_across_what_is_wanted_makes_none():
    standstill = Standstill()
    for k in range(60):
        attempt = Attempt(k * TICK_NS, "run", "", WANT, ZERO, "ball")
        said = standstill.step(attempt, state(k, position=(0.0, 0.01 * (k % 2), 0.0)), 0)
    assert said == "obstacle 'ball'"
