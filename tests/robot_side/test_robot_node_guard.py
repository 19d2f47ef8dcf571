"""The guard in the robot's program: between watchdog and robot, told in the state, counted in the result."""

import msgspec
import pytest

from farhand.common.geometry import STILL
from farhand.common.messages.intervention import Intervention
from farhand.common.messages.scene import Obstacle
from farhand.robot_side.robot_node import RobotNode
from farhand.robot_side.robots.point import PointRobot
from farhand.robot_side.safety.guard.settings import GuardSettings
from farhand.runs.scenario import load_scenario, replace_settings
from farhand.testing import ScriptedLink, ScriptedRobot, command, echo_of

SCENARIO = replace_settings(
    load_scenario("point-obstacle"),
    {"obstacles": [{"id": "post", "position": [1.1, 0.0, 0.6], "radius": 0.2}], "targets": [[0.6, 0.0, 0.9]]},
)


def _drive(scenario, robot, seconds=2.0, velocity=(1.0, 0.0, 0.0)):
    """A node whose operator drives as said; its states."""
    link = ScriptedLink("r")
    node = RobotNode(scenario, robot, link, "r", session=9)
    now_ns, seq, states = node.step(0), 0, []
    while now_ns < seconds * 1e9:
        new = link.take("state")
        states += new
        if new:
            seq += 1
            link.feed(command(seq, velocity=velocity, plan=(velocity,) * 5, echo=echo_of(new[-1])))
        now_ns = node.step(now_ns)
    return node, states


def test_it_stops_before_the_post_and_says_so():
    robot = PointRobot(SCENARIO.start, SCENARIO.robot.lag)
    node, states = _drive(SCENARIO, robot)
    told = [state.guard for state in states if state.guard is not msgspec.UNSET]
    assert told
    assert all((did.part, did.obstacle, did.what) == ("tool", "post", "slowed") for did in told)
    assert told[-1].asked == pytest.approx(1.0)
    result = node.summary()
    assert result.min_clearance is not None
    assert SCENARIO.guard.d_min < result.min_clearance < 0.02
    assert (result.guarded, result.guard_times) == (True, 1)
    assert result.guard_seconds == pytest.approx(sum(result.guard_deeds.values()))
    assert [(pair.part, pair.obstacle) for pair in result.guard_pairs] == [("tool", "post")]


def test_switched_off_it_lets_it_collide():
    off = msgspec.structs.replace(SCENARIO, guard=GuardSettings(on=False))
    node, states = _drive(off, PointRobot(off.start, off.robot.lag))
    result = node.summary()
    assert result.min_clearance is not None
    assert result.min_clearance < 0.0
    assert not result.guarded
    assert all(state.guard is msgspec.UNSET for state in states)


class _Guarded(ScriptedRobot):
    """A robot with a guard of its own."""

    guards_itself = True
    halted = 0

    def halt(self, dt):
        self.halted += 1

    def intervention(self):
        return Intervention(
            part="forearm", obstacle="post", distance=0.02, limit=0.013, asked=1.0, done=0.1, what="slowed"
        )


def test_a_robot_with_a_guard_of_its_own_is_told_what_is_around_it():
    robot = _Guarded(SCENARIO.start)
    _, states = _drive(SCENARIO, robot, 0.2)
    assert robot.surroundings is not None
    assert robot.surroundings.ids == ("post",)
    assert robot.told[-1][0] == (1.0, 0.0, 0.0)
    assert states[-1].guard.part == "forearm"


def test_a_latched_stop_steps_aside_from_nothing():
    robot = _Guarded(SCENARIO.start)
    link = ScriptedLink("r")
    node = RobotNode(SCENARIO, robot, link, "r", session=9)
    now_ns = node.step(0)
    node.watchdog.fault("test", now_ns)
    told = len(robot.told)
    node.step(now_ns)
    assert robot.halted == 1
    assert len(robot.told) == told


def _silent(estop_at=99.0, **settings):
    """Who drove is silent from 0.1 s on, beside a ball that comes at 0.2 m/s, and is there when the stop is latched."""
    comes = {"id": "comes", "position": [0.65, 0.0, 0.43], "radius": 0.2, "velocity": [-0.2, 0.0, 0.0]}
    scenario = replace_settings(
        SCENARIO, {"obstacles": [comes], "start": [0.0, 0.0, 0.6], "targets": [[0.0, 0.5, 0.6]], **settings}
    )
    robot = PointRobot(scenario.start, scenario.robot.lag)
    link = ScriptedLink("r")
    node = RobotNode(scenario, robot, link, "r", session=9)
    now_ns, states, sent = node.step(0), [], False
    while now_ns < 13e9:
        states += link.take("state")
        if states and not sent:
            sent = link.feed(command(1, velocity=(0.0, 0.0, 0.0), echo=echo_of(states[-1]))) is None
        if node.watchdog.mode == "stopped" and now_ns > estop_at * 1e9 and any(s.guard for s in states[-5:]):
            link.feed(command(2, "estop", session=77))
        now_ns = node.step(now_ns)
    assert node.watchdog.stands(now_ns)
    return node.summary(), states


@pytest.mark.parametrize("seconds", [10.0, 0.1])
def test_in_a_stop_that_silence_brought_the_guard_still_steps_aside_while_something_comes(seconds):
    result, states = _silent(**{"safety.evade_timeout": seconds})
    stopped = [state for state in states if state.mode == "stopped"]
    assert stopped[0].t_sent_ns < 1.7e9
    assert any(state.guard and state.guard.what == "evading" for state in stopped)
    assert result.min_clearance is not None
    assert result.min_clearance > SCENARIO.guard.d_min
    assert (result.stops, result.holds) == (1, 1)
    assert stopped[-1].velocity == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)


def test_what_comes_late_moves_nobody_who_has_stood_since_nothing_moved():
    scenario = replace_settings(
        SCENARIO, {"obstacles": [], "start": [0.0, 0.0, 0.6], "targets": [[0.0, 0.5, 0.6]]}
    )
    robot, link = PointRobot(scenario.start, scenario.robot.lag), ScriptedLink("r")
    node = RobotNode(scenario, robot, link, "r", session=9)
    now_ns, states, sent = node.step(0), [], False
    while now_ns < 13e9:  # when the guard may not move it any more
        states += link.take("state")
        if states and not sent:
            sent = link.feed(command(1, velocity=(0.0, 0.0, 0.0), echo=echo_of(states[-1]))) is None
        now_ns = node.step(now_ns)
    assert states[-1].mode == "stopped"
    node.replace_obstacles([Obstacle("late", (1.0, 0.0, 0.6), 0.2, velocity=(-0.5, 0.0, 0.0))], now_ns)
    while now_ns < 17e9:
        now_ns = node.step(now_ns)
        states += link.take("state")
    assert {state.position for state in states} == {scenario.start}
    assert all(state.evades is msgspec.UNSET for state in states)


def test_after_another_stop_nothing_says_that_the_guard_moves_it():
    """The emergency stop comes while it steps aside, between two states."""
    result, states = _silent(estop_at=2.5)
    assert result.mode == "estop"
    stopped = [state for state in states if state.mode == "stopped"]
    assert any(state.guard for state in stopped)
    assert all(state.evades for state in stopped)
    estopped = [state for state in states if state.mode == "estop"]
    assert not any(state.guard or state.evades for state in estopped)


@pytest.mark.parametrize("fails", ["arm_clearance", "held_by"])
def test_a_fault_while_a_state_is_made_is_in_that_state(fails):
    robot, link = _Guarded(SCENARIO.start), ScriptedLink("r")
    node = RobotNode(SCENARIO, robot, link, "r", session=9)
    now_ns = node.step(0)
    link.take("state")

    def broken(*_):
        raise RuntimeError("sensor")

    setattr(robot, fails, broken)
    states = []
    while not states:
        now_ns = node.step(now_ns)
        states += link.take("state")
    assert (states[0].mode, states[0].reason) == ("stopped", "fault: RuntimeError: sensor")
    assert not states[0].guard
    assert not states[0].evades


def test_told_not_to_it_stands_in_the_way():
    result, states = _silent(**{"safety.evade_timeout": 0.0})
    assert all(state.guard is msgspec.UNSET for state in states if state.mode == "stopped")
    assert result.min_clearance is not None
    assert result.min_clearance < 0.0


def test_other_robots_halt_by_standing_still():
    robot = ScriptedRobot((0.0, 0.0, 0.0))
    robot.halt(0.01)
    assert robot.told == [(STILL.linear, 0.01)]
