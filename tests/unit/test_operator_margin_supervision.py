"""Margin laws, the supervision table, and the paper's tester."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from common.messages import RobotState, Scene
from common.scenario import ControllerSettings, MarginSettings, OperatorSettings
from operator_side.margin import MarginInput, make_margin
from operator_side.steering.device import SteeringInput
from operator_side.steering.tester import ACKNOWLEDGE_PERIOD_NS
from operator_side.steering.tester import Tester as PaperTester
from operator_side.supervision import decide

ME, OTHER = 7, 8
GIVEN = MarginInput(speed=0.4, rtt_mean=0.1, rtt_std=0.02, innovation=0.03, spread=0.05)


def law(kind, **changes):
    return make_margin(MarginSettings(kind=kind, **changes), ControllerSettings(max_speed=0.5))


def test_no_margin():
    margin = law("none").evaluate(GIVEN)
    assert (margin.sigma, margin.inflation) == (0.0, 0.0)


def test_the_papers_margin():
    margin = law("paper", k_sigma=2.0).evaluate(GIVEN)
    assert margin.sigma == pytest.approx(0.4 * 0.1 + 0.5 * 2.0 * 0.02)
    assert margin.inflation == 0.0
    assert margin.sigma == pytest.approx(sum(margin.parts.values()))


nonnegative = st.floats(0, 10)


@given(nonnegative, nonnegative)
def test_the_adaptive_margin_is_the_largest_of_its_parts_within_its_bounds(innovation, spread):
    margin = law("adaptive", floor=0.02, cap=0.3).evaluate(MarginInput(1.0, 9.0, 9.0, innovation, spread))
    assert margin.sigma == 0.0
    assert 0.02 <= margin.inflation <= 0.3
    assert margin.inflation == min(0.3, max(0.02, innovation, spread))
    assert margin.parts == {"floor": 0.02, "innovation": innovation, "spread": spread}


def state(mode="run", holder=ME, position=(0.0, 0.0, 0.0)):
    return RobotState(
        source="r", session=9, seq=1, t_sent_ns=0, t_sample_ns=0, position=position, velocity=(0.0, 0.0, 0.0),
        clearance=1.0, min_clearance=1.0, mode=mode, reason="why", holder=holder,
    )  # fmt: skip


def scene(*targets):
    return Scene(
        source="r", session=9, seq=1, t_sent_ns=0, t_sample_ns=0, robot_radius=0.1, targets=tuple(targets)
    )


ON = SteeringInput((1.0, 0.0, 0.0), engaged=True)
OFF = SteeringInput()
ACKNOWLEDGING = SteeringInput((1.0, 0.0, 0.0), engaged=True, acknowledge=True)
ESTOP = SteeringInput(engaged=True, estop=True)


@pytest.mark.parametrize(
    ("robot", "seen", "steering", "mode", "reason"),
    [
        (None, None, None, None, "no state"),
        (None, scene(), None, None, "no state"),
        (state(), None, None, None, "no scene"),
        (state(holder=OTHER), scene(), ON, None, "another operator holds control (session 8)"),
        (state("stopped", OTHER), scene(), ACKNOWLEDGING, None, "another operator"),
        (state(holder=0), scene(), ON, "acknowledge", "asking for control"),
        (state(holder=0), scene(), OFF, "acknowledge", "asking for control"),
        (state(), scene(), ESTOP, "estop", "emergency stop"),
        (state(holder=OTHER), scene(), ESTOP, "estop", "emergency stop"),
        (state("stopped"), scene(), ESTOP, "estop", "emergency stop"),
        (state("stopped"), scene(), ACKNOWLEDGING, "acknowledge", "acknowledging: why"),
        (state("estop"), scene(), ACKNOWLEDGING, "acknowledge", "acknowledging: why"),
        (state("stopped"), scene(), ON, "hold", "robot stopped: why"),
        (state("estop"), scene(), ON, "hold", "robot estop: why"),
        (state("stopped", 0), scene(), ON, "hold", "robot stopped"),
        (state(), scene(), OFF, "hold", "not engaged"),
        (state("hold"), scene(), ON, "run", ""),
        (state("run"), scene(), ON, "run", ""),
    ],
)
def test_the_supervision_table(robot, seen, steering, mode, reason):
    decision = decide(robot, seen, steering, ME)
    assert decision.mode == mode
    assert reason in decision.reason
    assert bool(decision.reason) == (mode != "run")


def test_the_testers_speed_law():
    s = OperatorSettings()
    for gap, speed in ((0.1, 0.05), (0.15, 0.05), (0.325, 0.275), (0.5, 0.5), (3.0, 0.5)):
        wanted = PaperTester(s).read(state(), scene((0.0, gap, 0.0)), 0)
        assert wanted.velocity == pytest.approx((0.0, speed, 0.0))
        assert wanted.engaged


def test_the_tester_heads_straight_for_one_target_after_the_other():
    tester, seen = (
        PaperTester(OperatorSettings(tolerance=0.02)),
        scene((1.0, 0, 0), (1.01, 0, 0), (0, 1.0, 0)),
    )
    assert (tester.progress, tester.finished) == ((0, 0), False)
    assert tester.read(state(), seen, 0).velocity[0] > 0
    assert tester.progress == (0, 3)
    toward = tester.read(state(position=(0.985, 0.0, 0.0)), seen, 0).velocity
    assert tester.progress == (1, 3)  # the second is still 25 mm away
    assert toward[0] > 0
    toward = tester.read(state(position=(1.0, 0.0, 0.0)), seen, 0).velocity
    assert tester.progress == (2, 3)
    assert toward[1] == pytest.approx(-toward[0])
    assert not tester.read(state(position=(0.0, 0.99, 0.0)), seen, 0).engaged
    assert tester.finished
    assert not PaperTester(OperatorSettings()).read(state(), scene(), 0).engaged


def test_the_tester_acknowledges_a_stop_twice_a_second_and_never_an_emergency_stop():
    tester, seen = PaperTester(OperatorSettings()), scene((1.0, 0, 0))
    period = ACKNOWLEDGE_PERIOD_NS
    asked = [tester.read(state("stopped"), seen, t).acknowledge for t in range(0, 3 * period, period // 5)]
    assert [k for k, yes in enumerate(asked) if yes] == [0, 5, 10]
    assert not tester.read(state("estop"), seen, 9 * period).acknowledge
    assert not tester.read(state("run"), seen, 9 * period).acknowledge
