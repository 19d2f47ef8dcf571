"""Kinds that break their promise: the node says who and what, stands, and never sends what they gave."""

import math

import numpy as np
import pytest

from farhand.common.errors import FarhandError
from farhand.operator_side.control.controller import ControlSolution, Status
from farhand.operator_side.control.settings import ControllerSettings
from farhand.operator_side.faults import checked_margin, checked_steering
from farhand.operator_side.margins.law import Margin, MarginLaw
from farhand.operator_side.operator_node import OperatorIdentity, OperatorNode
from farhand.operator_side.steering.device import SteeringDevice, SteeringInput
from farhand.runs.scenario import load_scenario, replace_setting
from farhand.testing import (
    ScriptedController,
    ScriptedDevice,
    ScriptedLink,
    description,
    echo_of,
    scene,
    state,
)

P = 100_000_000


class Breaking(SteeringDevice):
    """Breaks off."""

    def read(self, view):
        raise OSError("unplugged")


class Wild(MarginLaw):
    """Gives what the test wants."""

    given = Margin()

    def evaluate(self, given):
        return Wild.given


def drive(device=None, controller=None):
    """The commands of a node that has control, and the node."""
    scenario = replace_setting(load_scenario("point-obstacle"), "controller.kind", "pass-through")
    link = ScriptedLink("r")
    node = OperatorNode(
        scenario,
        controller or ScriptedController((0.2, 0.0, 0.0), settings=ControllerSettings()),
        device or ScriptedDevice((0.2, 0.0, 0.0)),
        link,
        OperatorIdentity("r", 7),
    )
    now, commands = 10 * P, []
    for tick in range(4):
        link.now_ns = now
        echo = echo_of(commands[-1]) if commands else None
        link.feed(state(tick, t_sent_ns=now, echo=echo, holder=7))
        link.feed(scene(tick))
        link.feed(description(tick))
        now = node.step(now)
        commands += link.take("command")
    return commands, node


def test_a_device_that_raises_is_named_and_the_robot_holds():
    commands, node = drive(device=Breaking())
    assert {command.mode for command in commands} == {"hold"}
    assert not any(any(command.velocity) for command in commands)
    assert node.report.stop_reason.startswith("fault: OSError: unplugged (test_faults.py, line ")
    assert node.fault


def test_a_controller_that_raises_in_mid_drive_is_followed_by_zeros():
    controller = ScriptedController((0.2, 0.0, 0.0), settings=ControllerSettings())
    answer = controller.answer

    def later(problem):
        if len(controller.problems) == 3:  # once only: it must not drive on afterwards
            raise ZeroDivisionError("singular")
        return answer

    controller.answer = later
    commands, node = drive(controller=controller)
    assert [command.mode for command in commands] == ["run", "run", "hold", "hold"]
    assert not any(commands[-1].velocity)
    assert not any(map(any, commands[-1].plan))
    assert "ZeroDivisionError: singular" in node.report.stop_reason


@pytest.mark.parametrize("plan", [np.full((10, 3), math.nan), np.zeros((2, 3)), np.zeros(3)])
def test_a_plan_that_is_none_is_never_sent(plan):
    controller = ScriptedController(ControlSolution(plan, Status.OPTIMAL), settings=ControllerSettings())
    commands, node = drive(controller=controller)
    assert {command.mode for command in commands} == {"hold"}
    assert node.report.stop_reason.startswith("fault: ")


def test_an_emergency_stop_goes_out_after_a_fault_too():
    _, node = drive(device=Breaking())
    node.emergency_stop()
    node.step(14 * P)
    assert node._link.take("command")[-1].mode == "estop"


@pytest.mark.parametrize(
    ("margin", "said"),
    [
        (Margin(inflation=-0.05), "inflation -0.05"),
        (Margin(inflation=math.nan), "inflation nan"),
        (Margin(sigma=-1.0), "sigma -1.0"),
        (Margin(sigma=math.inf), "sigma inf"),
        (Margin(parts={"x": "y"}), "a part 'x' of 'y'"),
        (Margin(parts={"x": math.nan}), "a part 'x' of nan"),
    ],
)
def test_a_margin_that_would_shrink_obstacles_or_cannot_be_told_is_refused(margin, said, monkeypatch):
    with pytest.raises(FarhandError, match="the margin law gave"):
        checked_margin(margin)
    monkeypatch.setattr(Wild, "given", margin)
    monkeypatch.setattr("farhand.operator_side.deciding.make_margin", lambda settings: Wild(None))
    commands, node = drive()
    assert not any(any(command.velocity) for command in commands)
    assert said in node.report.stop_reason


@pytest.mark.parametrize(
    "wish", [None, SteeringInput((math.nan, 0.0, 0.0), True), SteeringInput((0.1,), True), "forward"]
)
def test_a_wish_that_is_none_is_refused(wish):
    with pytest.raises(FarhandError, match="the steering device"):
        checked_steering(wish)


def test_what_is_right_passes():
    margin, wish = Margin(inflation=0.1, parts={"x": 0.1}), SteeringInput((0.1, 0.0, 0.0), True)
    assert checked_margin(margin) is margin
    assert checked_steering(wish) is wish
