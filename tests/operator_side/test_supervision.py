"""The supervision table, and what it remembers from tick to tick."""

import pytest

from farhand.operator_side.steering.device import SteeringInput
from farhand.operator_side.supervision import ASK_PERIOD_NS, Seat, Supervision, decide
from farhand.testing import messages

ME, OTHER = 7, 8
NAMES = {0: "", ME: "me", OTHER: "other"}


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
    ("robot", "lacking", "steering", "mode", "reason"),
    [
        (None, "state", None, None, "no state"),
        (None, "state", ESTOP, "estop", "emergency stop"),
        (state(), "scene", None, None, "no scene"),
        (state(), "description", None, None, "no description"),
        (
            state(holder=OTHER),
            scene(),
            OFF,
            "acknowledge",
            "other holds control; waiting; it can hand over to you with `farhand handover --to me --robot r`",
        ),
        (state("stopped", OTHER), "", ACKNOWLEDGING, "acknowledge", "other holds control"),
        (state(holder=0), "", ON, "acknowledge", "asking for control"),
        (state(holder=0), "", OFF, "acknowledge", "asking for control"),
        (state(), "", ESTOP, "estop", "emergency stop"),
        (state(holder=OTHER), "", ESTOP, "estop", "emergency stop"),
        (state("stopped"), "", ESTOP, "estop", "emergency stop"),
        (state("stopped"), "", ACKNOWLEDGING, "acknowledge", "acknowledging: why"),
        (state("estop"), "", ACKNOWLEDGING, "acknowledge", "acknowledging: why"),
        (state("stopped"), "", ON, "hold", "robot stopped: why"),
        (state("estop"), "", ON, "hold", "robot estop: why"),
        (state("stopped", 0), "", ON, "hold", "robot stopped"),
        (state(), "", OFF, "hold", "not engaged"),
        (state("hold"), "", ON, "run", ""),
        (state("run"), "", ON, "run", ""),
    ],
)
def test_the_supervision_table(robot, lacking, steering, mode, reason):
    decision = decide(robot, lacking, steering, Seat(ME, "me"))
    assert decision.mode == mode
    assert reason in decision.reason
    assert bool(decision.reason) == (mode != "run")
    assert decision.asking == (robot is not None and robot.holder == OTHER and mode == "acknowledge")


@pytest.mark.parametrize("mode", ["hold", "stopped", "estop"])
@pytest.mark.parametrize("end", ["", "silent", "released"])
def test_who_waited_takes_control_by_itself_only_after_a_release(mode, end):
    """An empty end is that of a robot that was restarted."""
    free, waited = state(mode, 0, lease_end=end), Seat(ME, "me", waited_for="other")
    acted, idle = (decide(free, "", steering, waited) for steering in (ACKNOWLEDGING, ON))
    assert acted.mode == "acknowledge"
    if end == "released":
        assert idle == decide(free, "", ON, Seat(ME, "me"))
        assert idle.mode == ("acknowledge" if mode == "hold" else "hold")
    else:
        assert idle.mode is None
        assert idle.reason == "other lost control without releasing it; acknowledge to take it"


def test_whom_it_waited_for_is_remembered_until_it_has_control():
    ours = Supervision(ME, "me")
    gone = state("hold", 0, lease_end="silent")
    assert ours.step(gone, "", ON, 0).mode == "acknowledge"  # it never waited
    assert ours.step(state(holder=OTHER), "", ON, 1).asking
    assert ours.step(gone, "", ON, 2).mode is None
    assert ours.step(state("hold"), "", ON, 3).mode == "run"
    assert ours.step(gone, "", ON, 4).mode == "acknowledge"  # now it was its own


def test_a_restarted_operator_does_not_wait_for_a_person_when_its_own_old_lease_ends():
    ours = Supervision(ME, "other")
    assert ours.step(state(holder=OTHER), "", ON, 0).asking
    assert ours.step(state("hold", 0, lease_end="silent"), "", ON, 1).mode == "acknowledge"


def test_it_asks_once_a_second():
    ours, fifth = Supervision(ME, "me"), ASK_PERIOD_NS // 5
    decisions = [ours.step(state(holder=OTHER), "", ON, k * fifth) for k in range(11)]
    assert [k for k, d in enumerate(decisions) if d.mode == "acknowledge"] == [0, 5, 10]
    assert len({d.reason for d in decisions}) == 1


@pytest.mark.parametrize("mode", ["run", "hold", "stopped", "estop"])
def test_a_handover_is_said_until_the_robot_shows_it(mode):
    ours, asked = Supervision(ME, "me"), ((OTHER, "other"),)
    ours.successor = OTHER
    for t in range(2):
        told = ours.step(state(mode, waiting=asked), "", ON, t)
        assert (told.mode, told.successor) == ("release", OTHER)
        assert told.reason == "handing control over to other"
    assert ours.step(state(mode, OTHER), "", ON, 2).asking
    assert ours.successor == 0


def test_a_handover_to_one_that_waits_no_more_is_given_up():
    ours = Supervision(ME, "me")
    ours.successor = OTHER
    assert ours.step(state(), "", ON, 0).mode == "run"
    assert ours.successor == 0


def test_with_two_robots_of_one_name_nothing_moves_but_an_emergency_stop_goes_out():
    supervision = Supervision(7, "operator")
    drive = SteeringInput((0.1, 0.0, 0.0), engaged=True)
    assert supervision.step(state(holder=7), "", drive, 0).mode == "run"
    supervision.twins = True
    held = supervision.step(state(holder=7), "", drive, 0)
    assert (held.mode, "two robots call themselves 'r'" in held.reason) == ("hold", True)
    assert supervision.step(state(holder=7), "", SteeringInput(estop=True), 0).mode == "estop"
