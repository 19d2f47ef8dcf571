"""The paper's tester and the progress through targets."""

import pytest

from farhand.operator_side.steering.device import SteeringInput, View
from farhand.operator_side.steering.targets import Targets
from farhand.operator_side.steering.tester.tester import (
    ACKNOWLEDGE_PERIOD_NS,
    FAULT_BACK_NS,
    FAULT_TRIES,
    TesterSettings,
)
from farhand.operator_side.steering.tester.tester import Tester as PaperTester
from farhand.operator_side.supervision import Seat, decide
from farhand.testing import messages

ME, OTHER = 7, 8
NAMES = {0: "", ME: "me", OTHER: "other"}


def state(mode="run", holder=ME, position=(0.0, 0.0, 0.0), **changes):
    return messages.state(
        mode=mode, reason="why", holder=holder, holder_name=NAMES[holder], position=position, **changes
    )


def scene(*targets):
    return messages.scene(targets=targets)


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


@pytest.mark.parametrize("settings", [{}, {"orientations": ((1.0, 0.0, 0.0, 0.0),)}, {"sidestep": True}])
def test_on_the_very_target_it_wishes_nothing(settings):
    """Where progress does not count, as after a restart of the robot, the next target may be where it stands."""
    targets = Targets(0.02)
    targets.update(state(), scene((0.0, 0.0, 0.0)), driving=False)
    wish = PaperTester(TesterSettings(**settings)).read(View(state(), scene(), targets, 0))
    assert wish.velocity == (0.0, 0.0, 0.0)
    assert wish.engaged


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


def fault(stops):
    return messages.state(mode="stopped", reason="fault: OSError: no motor", stops=stops, holder=ME)


def test_the_tester_gives_up_on_a_fault_that_comes_back_and_says_so():
    """The robot leaves its stop for a tick, and is in the next one: its count of stops tells."""
    seat, stops, asked = Driver((1.0, 0, 0)), 1, 0
    for k in range(200):
        wanted = seat.read(fault(stops), k * 100_000_000)
        if wanted.acknowledge:
            asked += 1
            stops += 1
    assert asked == FAULT_TRIES
    assert (wanted.acknowledge, wanted.says) == (
        False,
        "the tester acknowledges it no more: it came back 3 times; see to the robot",
    )


def test_the_tester_goes_on_asking_where_acknowledgements_get_lost():
    seat = Driver((1.0, 0, 0))
    asked = [seat.read(fault(1), k * ACKNOWLEDGE_PERIOD_NS).acknowledge for k in range(50)]
    assert all(asked)


def test_faults_that_are_far_between_are_acknowledged_each():
    seat = Driver((1.0, 0, 0))
    for stops in range(1, 20):
        now = stops * (FAULT_BACK_NS + ACKNOWLEDGE_PERIOD_NS)
        assert seat.read(fault(stops), now).acknowledge
        assert seat.read(state("run"), now + 1).engaged


def test_what_the_tester_says_is_in_the_reason():
    says = SteeringInput(engaged=True, says="see to the robot")
    decision = decide(fault(3), "", says, Seat(ME))
    assert (decision.mode, decision.reason) == (
        "hold",
        "robot stopped: fault: OSError: no motor; see to the robot",
    )
