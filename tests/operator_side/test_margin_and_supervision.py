"""Margin laws, the supervision table, and the paper's tester."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from farhand.operator_side.margins.law import MarginInput
from farhand.operator_side.margins.registry import make_margin
from farhand.operator_side.settings import MarginSettings
from farhand.operator_side.steering.device import SteeringInput, View
from farhand.operator_side.steering.targets import Targets
from farhand.operator_side.steering.tester import ACKNOWLEDGE_PERIOD_NS, TesterSettings
from farhand.operator_side.steering.tester import Tester as PaperTester
from farhand.operator_side.supervision import ASK_PERIOD_NS, Seat, Supervision, decide
from farhand.testing import messages

ME, OTHER = 7, 8
NAMES = {0: "", ME: "me", OTHER: "other"}
GIVEN = MarginInput(speed=0.4, rtt_mean=0.1, rtt_std=0.02, innovation=0.03, spread=0.05)


def law(kind, **changes):
    return make_margin(MarginSettings(kind=kind, own={kind: changes}))


def test_no_margin():
    margin = law("none").evaluate(GIVEN)
    assert (margin.sigma, margin.inflation) == (0.0, 0.0)


def test_the_papers_margin():
    margin = law("paper", k_sigma=2.0, max_speed=0.5).evaluate(GIVEN)
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


def state(mode="run", holder=ME, position=(0.0, 0.0, 0.0), **changes):
    return messages.state(
        mode=mode, reason="why", holder=holder, holder_name=NAMES[holder], position=position, **changes
    )


def scene(*targets):
    return messages.scene(targets=targets)


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
        (
            state(holder=OTHER),
            scene(),
            OFF,
            "acknowledge",
            "other holds control; waiting; it can hand over to you with `farhand handover --to me --robot r`",
        ),
        (state("stopped", OTHER), scene(), ACKNOWLEDGING, "acknowledge", "other holds control"),
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
    decision = decide(robot, seen, steering, Seat(ME, "me"))
    assert decision.mode == mode
    assert reason in decision.reason
    assert bool(decision.reason) == (mode != "run")
    assert decision.asking == (robot is not None and robot.holder == OTHER and mode == "acknowledge")


@pytest.mark.parametrize("mode", ["hold", "stopped", "estop"])
@pytest.mark.parametrize("end", ["", "silent", "released"])
def test_who_waited_takes_control_by_itself_only_after_a_release(mode, end):
    """An empty end is that of a robot that was restarted."""
    free, waited = state(mode, 0, lease_end=end), Seat(ME, "me", waited_for="other")
    acted, idle = (decide(free, scene(), steering, waited) for steering in (ACKNOWLEDGING, ON))
    assert acted.mode == "acknowledge"
    if end == "released":
        assert idle == decide(free, scene(), ON, Seat(ME, "me"))
        assert idle.mode == ("acknowledge" if mode == "hold" else "hold")
    else:
        assert idle.mode is None
        assert idle.reason == "other lost control without releasing it; acknowledge to take it"


def test_whom_it_waited_for_is_remembered_until_it_has_control():
    ours = Supervision(ME, "me")
    gone = state("hold", 0, lease_end="silent")
    assert ours.step(gone, scene(), ON, 0).mode == "acknowledge"  # it never waited
    assert ours.step(state(holder=OTHER), scene(), ON, 1).asking
    assert ours.step(gone, scene(), ON, 2).mode is None
    assert ours.step(state("hold"), scene(), ON, 3).mode == "run"
    assert ours.step(gone, scene(), ON, 4).mode == "acknowledge"  # now it was its own


def test_a_restarted_operator_does_not_wait_for_a_person_when_its_own_old_lease_ends():
    ours = Supervision(ME, "other")
    assert ours.step(state(holder=OTHER), scene(), ON, 0).asking
    assert ours.step(state("hold", 0, lease_end="silent"), scene(), ON, 1).mode == "acknowledge"


def test_it_asks_once_a_second():
    ours, fifth = Supervision(ME, "me"), ASK_PERIOD_NS // 5
    decisions = [ours.step(state(holder=OTHER), scene(), ON, k * fifth) for k in range(11)]
    assert [k for k, d in enumerate(decisions) if d.mode == "acknowledge"] == [0, 5, 10]
    assert len({d.reason for d in decisions}) == 1


@pytest.mark.parametrize("mode", ["run", "hold", "stopped", "estop"])
def test_a_handover_is_said_until_the_robot_shows_it(mode):
    ours, asked = Supervision(ME, "me"), ((OTHER, "other"),)
    ours.successor = OTHER
    for t in range(2):
        told = ours.step(state(mode, waiting=asked), scene(), ON, t)
        assert (told.mode, told.successor) == ("release", OTHER)
        assert told.reason == "handing control over to other"
    assert ours.step(state(mode, OTHER), scene(), ON, 2).asking
    assert ours.successor == 0


def test_a_handover_to_one_that_waits_no_more_is_given_up():
    ours = Supervision(ME, "me")
    ours.successor = OTHER
    assert ours.step(state(), scene(), ON, 0).mode == "run"
    assert ours.successor == 0


class Driver:
    """A tester before the targets of a scene."""

    def __init__(self, *targets, tolerance=0.02):
        self.tester, self.targets = PaperTester(TesterSettings()), Targets(tolerance)
        self.scene = scene(*targets)

    def read(self, state, now_ns=0):
        self.targets.update(state, self.scene)
        return self.tester.read(View(state, self.scene, self.targets, now_ns))

    @property
    def progress(self):
        return self.targets.reached, self.targets.count


def test_the_testers_speed_law():
    for gap, speed in ((0.1, 0.05), (0.15, 0.05), (0.325, 0.275), (0.5, 0.5), (3.0, 0.5)):
        wanted = Driver((0.0, gap, 0.0)).read(state())
        assert wanted.velocity == pytest.approx((0.0, speed, 0.0))
        assert wanted.engaged


def test_the_tester_heads_straight_for_one_target_after_the_other():
    seat = Driver((1.0, 0, 0), (1.01, 0, 0), (0, 1.0, 0))
    assert (seat.progress, seat.targets.finished) == ((0, 0), False)
    assert seat.read(state()).velocity[0] > 0
    assert seat.progress == (0, 3)
    toward = seat.read(state(position=(0.985, 0.0, 0.0))).velocity
    assert seat.progress == (1, 3)  # the second is still 25 mm away
    assert toward[0] > 0
    toward = seat.read(state(position=(1.0, 0.0, 0.0))).velocity
    assert seat.progress == (2, 3)
    assert toward[1] == pytest.approx(-toward[0])
    assert not seat.read(state(position=(0.0, 0.99, 0.0))).engaged
    assert seat.targets.finished
    assert not Driver().read(state()).engaged


def test_the_tester_acknowledges_a_stop_twice_a_second_and_never_an_emergency_stop():
    seat = Driver((1.0, 0, 0))
    period = ACKNOWLEDGE_PERIOD_NS
    asked = [seat.read(state("stopped"), t).acknowledge for t in range(0, 3 * period, period // 5)]
    assert [k for k, yes in enumerate(asked) if yes] == [0, 5, 10]
    assert not seat.read(state("estop"), 9 * period).acknowledge
    assert not seat.read(state("run"), 9 * period).acknowledge
    assert not seat.read(state("estop", 0), 9 * period).acknowledge
    assert seat.read(state("hold", 0), 9 * period).acknowledge  # free control is taken
    assert not seat.read(state("hold", OTHER), 10 * period).acknowledge
