"""Predictors against an ideal robot: z' = u, where u is the newest command that has arrived, then its plan."""

import math
from itertools import pairwise

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from farhand.common.geometry import Twist, turn_between
from farhand.common.messages.report import UPRIGHT
from farhand.operator_side.prediction.command_history import KEPT, CommandHistory
from farhand.operator_side.prediction.innovations import Innovations
from farhand.operator_side.prediction.law import Known
from farhand.operator_side.prediction.registry import PREDICTORS
from farhand.robot_side.robots.point import PointRobot
from farhand.robot_side.robots.registry import make_robot
from farhand.runs.scenario import load_scenario
from farhand.testing import state

ME, PERIOD, LAG = 7, 0.1, 0.08
P_NS = 100_000_000
ZERO = (0.0, 0.0, 0.0)
speed = st.floats(-0.5, 0.5)
velocity = st.tuples(speed, speed, speed)
plans = st.lists(velocity, min_size=1, max_size=4).map(tuple)


class World:
    """Commands 0..n-1 sent at k * PERIOD; `arrived` says which reach the robot, `up` s later."""

    def __init__(self, commands, up, arrived=None):
        self.commands, self.up = commands, up
        self.arrived = set(range(len(commands))) if arrived is None else set(arrived)
        self.history = CommandHistory()
        for seq, velocities in enumerate(commands):
            self.history.add(seq, seq * P_NS, PERIOD, velocities, ZERO)

    def playing(self, t):
        """The command that the robot plays at `t`, and for how long it has."""
        there = [s for s in self.arrived if s * PERIOD + self.up <= t + 1e-9]
        if not there:
            return None, 0.0
        return max(there), max(0.0, t - max(there) * PERIOD - self.up)

    def z(self, t):
        """Integral of u from 0 to t."""
        position = [0.0, 0.0, 0.0]
        edges = sorted({0.0, t, *(k * PERIOD + self.up for k in range(200) if k * PERIOD + self.up < t)})
        for a, b in pairwise(edges):
            s, held = self.playing((a + b) / 2)
            if s is None:
                continue
            entry = int(held / PERIOD)
            u = self.commands[s][entry] if entry < len(self.commands[s]) else ZERO
            position = [x + v * (b - a) for x, v in zip(position, u, strict=True)]
        return tuple(position)

    def state(self, t, v=(0.2, -0.1, 0.05)):
        """What the robot reports at `t`: x such that x + LAG v = z."""
        s, held = self.playing(t)
        return state(
            position=tuple(z - LAG * w for z, w in zip(self.z(t), v, strict=True)),
            velocity=v,
            applied_session=0 if s is None else ME,
            applied_seq=s or 0,
            applied_for_ns=round(held * 1e9),
        )

    def predict(self, law, sampled, seq, rtt_mean=0.0, v=(0.2, -0.1, 0.05)):
        predictor = PREDICTORS.get(law)(Known(self.history, ME, PERIOD, LAG))
        return predictor.predict(self.state(sampled, v), seq, seq * P_NS, rtt_mean)


def off_edge(t, up):
    """Away from the instant at which a command takes effect, where before and after are a rounding apart."""
    return 1e-6 < math.fmod(t - up + 100 * PERIOD, PERIOD) < PERIOD - 1e-6


worlds = st.tuples(st.lists(plans, min_size=3, max_size=9), st.floats(0.0, 0.35), st.floats(0.0, 0.3))


@pytest.mark.parametrize("law", ["echo", "timeline"])
@given(world=worlds)
def test_exact_when_the_delay_is_constant_and_nothing_is_lost(law, world):
    commands, up, down = world
    seq, rig = len(commands), World(commands, up)
    sampled = seq * PERIOD - down
    assume(sampled > up + 1e-6 and off_edge(sampled, up))
    found = rig.predict(law, sampled, seq)
    assert math.dist(found.start, rig.z(seq * PERIOD + up)) < 1e-7
    assert found.look == pytest.approx(seq * PERIOD + up - sampled, abs=1e-6)


@given(worlds, st.sets(st.integers(0, 8)))
def test_timeline_knows_of_losses_that_were_due(world, lost):
    commands, up, down = world
    seq = len(commands)
    sampled = seq * PERIOD - down
    due = [s for s in range(seq) if s * PERIOD + up <= sampled]
    arrived = [s for s in range(seq) if s not in due or s not in lost]
    assume(off_edge(sampled, up) and set(arrived) & set(due))
    rig = World(commands, up, arrived)
    found = rig.predict("timeline", sampled, seq)
    assert math.dist(found.start, rig.z(seq * PERIOD + up)) < 1e-7


@given(worlds, st.integers(0, 8))
def test_spread_covers_the_loss_of_all_commands_after_any_one(world, last_arrived):
    commands, up, down = world
    seq = len(commands)
    sampled = seq * PERIOD - down
    assume(sampled > up + 1e-6 and off_edge(sampled, up))
    due = [s for s in range(seq) if s * PERIOD + up <= sampled]
    arrived = [s for s in range(seq) if s in due or s <= last_arrived]
    rig = World(commands, up, arrived)
    found = rig.predict("timeline", sampled, seq)
    assert math.dist(found.start, rig.z(seq * PERIOD + up)) <= found.spread + 1e-7


@given(worlds)
def test_history_is_exact_for_constant_delay_when_the_round_trip_is_known(world):
    commands, up, down = world
    commands = [c[:1] * 5 for c in commands]
    seq, rig = len(commands), World(commands, up)
    sampled = seq * PERIOD - down
    assume(sampled >= up and up + down > 0)
    found = rig.predict("history", sampled, seq, rtt_mean=up + down, v=ZERO)
    assert math.dist(found.start, rig.z(seq * PERIOD + up)) < 1e-7
    assert found.look == up + down


@given(velocity, st.floats(0, 0.3), st.floats(0, 0.3))
def test_last_command_is_exact_for_a_velocity_that_does_not_change(u, up, down):
    rig = World([(u,) * 5] * 12, up)
    sampled = 1.2 - down
    found = rig.predict("last-command", sampled, 12, rtt_mean=up + down, v=ZERO)
    assert math.dist(found.start, rig.z(1.2 + up)) < 1e-7


def test_no_prediction_is_the_reported_position():
    rig = World([((0.1, 0.0, 0.0),)] * 5, 0.1)
    assert rig.predict("none", 0.4, 5, rtt_mean=0.2).start == rig.state(0.4).position


@pytest.mark.parametrize("law", ["none", "last-command", "history", "echo", "timeline"])
def test_before_anything_was_sent_the_robot_is_where_it_is(law):
    rig = World([], 0.1)
    found = rig.predict(law, 0.0, 0, rtt_mean=0.2, v=ZERO)
    assert (found.start, found.spread) == (ZERO, 0.0)


@pytest.mark.parametrize("law", ["echo", "timeline"])
def test_a_state_that_applies_someone_elses_command_is_only_compensated_for_lag(law):
    rig = World([((0.1, 0.0, 0.0),)] * 5, 0.1)
    predictor = PREDICTORS.get(law)(Known(rig.history, ME + 1, PERIOD, LAG))
    found = predictor.predict(rig.state(0.45), 5, 5 * P_NS, 0.0)
    assert math.dist(found.start, rig.z(0.45)) < 1e-12


def test_an_exhausted_plan_stands_still():
    rig = World([((0.5, 0.0, 0.0), (0.2, 0.0, 0.0))], 0.0)
    found = rig.predict("timeline", 0.05, 40)
    assert found.start == pytest.approx((0.07, 0.0, 0.0))
    assert rig.predict("timeline", 3.95, 40).start == pytest.approx((0.07, 0.0, 0.0))
    command = rig.history.get(0)
    assert command.velocity(2) == ZERO
    assert command.displacement(0.15) == pytest.approx((0.06, 0.0, 0.0))
    assert command.displacement(99.0) == pytest.approx((0.07, 0.0, 0.0))


def test_sequence_numbers_that_were_never_sent_are_filled_by_the_plan():
    rig = World([((0.1, 0.0, 0.0),) * 9], 0.0)
    rig.history.add(3, 3 * P_NS, PERIOD, ((0.5, 0.0, 0.0),), ZERO)
    assert rig.predict("timeline", 0.05, 4).start == pytest.approx((0.3 * 0.1 + 0.1 * 0.5, 0.0, 0.0))


def test_history_forgets_the_oldest():
    history = CommandHistory()
    for seq in range(KEPT + 3):
        history.add(seq, seq, PERIOD, (ZERO,), ZERO)
    assert history.get(2) is None
    assert history.get(3).seq == 3
    assert [c.seq for c in history.newest_first()][:2] == [KEPT + 2, KEPT + 1]


@given(st.lists(st.tuples(velocity, st.floats(0.001, 0.3)), min_size=1, max_size=5))
def test_lag_compensated_position_of_a_lagging_robot_follows_the_command_exactly(moves):
    robot, z = PointRobot((0.0, 0.0, 0.0), LAG), ZERO
    for u, duration in moves:
        robot.step(Twist(u), duration)
        z = tuple(a + b * duration for a, b in zip(z, u, strict=True))
        sample = robot.sample()
        now = tuple(x + LAG * v for x, v in zip(sample.position, sample.velocity, strict=True))
        assert math.dist(now, z) < 1e-12


def innovation_rig():
    history = CommandHistory()
    for seq in range(10):
        history.add(seq, seq * P_NS, PERIOD, ((0.1, 0.0, 0.0),), (0.01 * seq, 0.0, 0.0))
    return Innovations(Known(history, ME, PERIOD, LAG), window=3)


def seen(seq, x, held=0.0, session=ME):
    held_ns = round(held * 1e9)
    return state(position=(x, 0.0, 0.0), applied_session=session, applied_seq=seq, applied_for_ns=held_ns)


def test_an_innovation_is_where_a_command_began_less_where_it_was_predicted_to():
    found = innovation_rig()
    found.observe(seen(1, 0.01 + 0.004 + 0.03, held=0.04))
    assert found.newest == pytest.approx(0.03)
    assert found.largest == pytest.approx(0.03)
    found.observe(seen(2, 0.02))
    assert found.newest == pytest.approx(0.0)
    assert found.largest == pytest.approx(0.03)


def test_each_command_is_looked_at_once_and_only_mine_and_within_the_window():
    found = innovation_rig()
    assert found.largest == 0.0
    found.observe(seen(3, 0.13))
    found.observe(seen(3, 0.93))
    found.observe(seen(2, 0.92))
    found.observe(seen(5, 0.95, session=8))
    found.observe(seen(77, 0.95))
    assert found.largest == pytest.approx(0.1)
    for seq in (4, 5, 6):
        found.observe(seen(seq, 0.01 * seq + 0.02))
    assert found.largest == pytest.approx(0.02)


def test_the_scenarios_point_is_such_a_robot():
    assert isinstance(make_robot(load_scenario("point-obstacle")), PointRobot)


TURN = (0.0, 0.3, 0.4)


def turning_world(lengths):
    """Commands that turn for so many periods each while their plans of five go on."""
    world = World([((0.1, 0.0, 0.0),) * 5] * len(lengths), 0.05)
    for seq, length in enumerate(lengths):
        world.history.add(seq, seq * P_NS, PERIOD, ((0.1, 0.0, 0.0),) * 5, ZERO, (TURN,) * length)
    return world


@pytest.mark.parametrize("law", ["timeline", "echo"])
def test_the_orientation_is_that_of_the_turns_under_way_on_the_same_timeline(law):
    world = turning_world([5] * 6)
    prediction = world.predict(law, 0.3, 5)
    assert prediction.look == pytest.approx(0.25)  # to the instant at which command 5 takes effect
    assert turn_between(UPRIGHT, prediction.orientation) == pytest.approx([rate * 0.25 for rate in TURN])


def test_a_turn_that_ends_before_its_plan_and_commands_that_were_lost_are_counted_on():
    world = turning_world([2] * 6)
    world.arrived = {0}
    prediction = world.predict("timeline", 0.1, 1)  # command 0 was applied for 0.05 s
    assert turn_between(UPRIGHT, prediction.orientation) == pytest.approx([rate * 0.05 for rate in TURN])
    late = world.predict("timeline", 0.5, 5)  # still 0, whose turn is over
    assert late.orientation == UPRIGHT


def test_a_body_that_turns_already_goes_on_for_its_lag():
    law = PREDICTORS.get("timeline")(Known(CommandHistory(), ME, PERIOD, LAG))
    seen = state(angular_velocity=TURN, applied_session=0)
    prediction = law.predict(seen, 0, 0, 0.0)
    assert turn_between(UPRIGHT, prediction.orientation) == pytest.approx([rate * LAG for rate in TURN])


@pytest.mark.parametrize(("law", "turned"), [("last-command", 0.2), ("history", 0.2), ("none", None)])
def test_laws_that_know_the_mean_round_trip_turn_by_it(law, turned):
    prediction = turning_world([5] * 6).predict(law, 0.5, 6, rtt_mean=0.2)
    if turned is None:
        assert prediction.orientation is None
    else:
        assert turn_between(UPRIGHT, prediction.orientation) == pytest.approx([r * turned for r in TURN])


@given(world=worlds)
def test_a_known_delay_is_exact_where_it_is_the_delay(world):
    commands, up, down = world
    seq, rig = len(commands), World(commands, up)
    sampled = seq * PERIOD - down
    assume(sampled > up + 1e-6 and off_edge(sampled, up))
    found = rig.predict("known-delay", sampled, seq, rtt_mean=up + down)
    assert found.start == pytest.approx(rig.z(seq * PERIOD + up), abs=1e-9)
    assert found.look == pytest.approx(up + down)


def test_a_known_delay_is_not_learned_anew():
    rig = World([((0.1, 0.0, 0.0),)] * 9, 0.1)
    law = PREDICTORS.get("known-delay")(Known(rig.history, ME, PERIOD, LAG))
    looks = [law.predict(rig.state(0.5), 9, 9 * P_NS, 0.1 if k < 40 else 0.4).look for k in range(60)]
    assert looks == [0.1] * 60
