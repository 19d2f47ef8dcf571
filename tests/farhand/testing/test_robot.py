import pytest

from farhand.common.geometry import Twist
from farhand.testing import ScriptedRobot


def test_it_follows_at_once_and_keeps_what_it_was_told():
    robot = ScriptedRobot((1.0, 0.0, 0.0))
    robot.step(Twist((0.1, 0.0, -0.2)), 0.5)
    robot.step(Twist((0.0, 0.2, 0.0)), 0.5)
    assert robot.sample().position == pytest.approx((1.05, 0.1, -0.1))
    assert robot.sample().velocity == (0.0, 0.2, 0.0)
    assert robot.told == [((0.1, 0.0, -0.2), 0.5), ((0.0, 0.2, 0.0), 0.5)]


def test_a_stuck_robot_stays_and_is_still_told():
    robot = ScriptedRobot()
    robot.stuck = True
    robot.step(Twist((0.1, 0.0, 0.0)), 1.0)
    assert robot.sample().position == (0.0, 0.0, 0.0)
    assert robot.told == [((0.1, 0.0, 0.0), 1.0)]


def test_it_shows_what_it_shall():
    robot = ScriptedRobot(clearance=0.3)
    robot.show(position=(2.0, 0.0, 0.0), joints=(1.0, 2.0))
    assert (robot.sample().position, robot.sample().joints) == ((2.0, 0.0, 0.0), (1.0, 2.0))
    assert robot.arm_clearance([]) == 0.3
    with pytest.raises(TypeError, match="colour"):
        robot.show(colour="red")


@pytest.mark.parametrize("call", ["sample", "step", "arm_clearance"])
def test_it_fails_so_often_in_the_call_it_is_told(call):
    robot = ScriptedRobot()
    calls = {
        "sample": robot.sample,
        "step": lambda: robot.step(Twist((1.0, 0.0, 0.0)), 0.1),
        "arm_clearance": lambda: robot.arm_clearance([]),
    }
    robot.fail(call, 2, OSError("cable"))
    for _ in range(2):
        with pytest.raises(OSError, match="cable"):
            calls[call]()
        assert robot.told == []
    for each in calls.values():
        each()
    robot.fail(call)
    for _ in range(100):
        with pytest.raises(OSError, match="cable"):
            calls[call]()


def test_the_usual_failure_and_the_end():
    robot = ScriptedRobot()
    robot.fail("sample", 1)
    with pytest.raises(RuntimeError, match="gearbox"):
        robot.sample()
    assert robot.closed == 0
    robot.close()
    assert robot.closed == 1
