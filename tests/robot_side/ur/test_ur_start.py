"""What is refused before a real arm may be driven from where it stands, in one line each."""

from types import SimpleNamespace

import msgspec
import numpy as np
import pytest

from farhand.common.errors import InputError, ScenarioError
from farhand.common.messages.scene import Obstacle
from farhand.common.timing.clock import SystemClock
from farhand.robot_side.arm.model import model
from farhand.robot_side.robots import ur_start
from farhand.robot_side.robots.pybullet_arm import ArmWorld
from farhand.robot_side.robots.ur_start import check_joints, first_facts
from farhand.robot_side.ur import poses
from farhand.robot_side.ur.settings import UrSettings
from farhand.robot_side.ur.states import Facts
from farhand.runs.scenario import load_scenario, replace_settings

ARM = model("ur5")
REAL = {"robot.kind": "ur", "robot.model": "ur5", "robot.host": "127.0.0.1"}
SCENARIO = replace_settings(load_scenario("ur5-obstacle"), REAL)
ZERO_TOOL = [0.0] * 6


def values(**changed):
    tcp = poses.tcp_pose(ARM, ARM.home, ZERO_TOOL)
    found = {
        "actual_q": ARM.home.tolist(),
        "actual_TCP_pose": tcp,
        "tcp_offset": ZERO_TOOL,
        "runtime_state": 1,
    }
    return found | {"payload": 0.0} | changed


@pytest.fixture
def look(monkeypatch):
    def go(said="UR5", settings=None, trouble="", **changed):
        class Dashboard:
            def __init__(self, host):
                pass

            def __enter__(self):
                return SimpleNamespace(ask=lambda _: said)

            def __exit__(self, *_):
                pass

        monkeypatch.setattr(ur_start, "Dashboard", Dashboard)
        monkeypatch.setattr(ur_start, "PATIENCE", 0.01)
        facts = Facts({} if trouble else values(**changed), 0.0, trouble)
        link = SimpleNamespace(poll=lambda now_ns, starts: facts)
        return first_facts(SCENARIO, link, settings or UrSettings(), SystemClock())

    return go


def test_an_arm_that_is_as_the_scenario_says_is_taken(look):
    assert look().values["payload"] == 0.0
    assert look(settings=UrSettings(payload=1.0)).values["payload"] == 0.0  # will be set
    assert look(settings=UrSettings(payload=1.0), payload=1.0).values["payload"] == 1.0


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"trouble": "no controller listens at this address"}, "no controller listens"),
        ({"trouble": "another client is in control: it owns"}, "another client is in control"),
        ({"said": "UR10"}, "a UR5, the controller at 127.0.0.1 says UR10"),
        ({"actual_TCP_pose": [0.1, 0.1, 0.1, 0, 0, 0]}, "it is another arm"),
        (
            {"settings": UrSettings(payload=1.0), "payload": 2.5},
            "the scenario has 1 kg, the controller 2.5 kg",
        ),
        ({"runtime_state": 2}, "another program runs"),
    ],
)
def test_what_must_not_be_driven_is_refused(look, given, said):
    with pytest.raises(InputError, match=said):
        look(**given)


def test_a_joint_outside_of_the_limits_is_named():
    q = ARM.home.copy()
    q[2] = 3.5
    with pytest.raises(ScenarioError, match=r"elbow_joint stands at 3\.500 rad, outside"):
        check_joints(SCENARIO, q)
    check_joints(SCENARIO, ARM.home)


def test_an_arm_that_stands_in_an_obstacle_is_refused():
    elbow = ARM.segments(ARM.home)[3].mean(axis=0)
    wall = Obstacle("wall", position=tuple(elbow.tolist()), radius=0.05)
    with pytest.raises(ScenarioError, match="wall"):
        ArmWorld(msgspec.structs.replace(SCENARIO, obstacles=(wall,)), np.array(ARM.home))
