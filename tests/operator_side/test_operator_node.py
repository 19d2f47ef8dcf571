"""The operator's node over an in-memory link, with a robot that says what the test wants."""

import itertools

import msgspec
import numpy as np
import pytest

from farhand.common.messages.base import Echo
from farhand.common.messages.codec import encode
from farhand.common.messages.scene import Obstacle
from farhand.operator_side.control.controller import Status
from farhand.operator_side.control.registry import make_controller
from farhand.operator_side.deciding import STALE_STATE
from farhand.operator_side.operator_node import OperatorIdentity, OperatorNode
from farhand.operator_side.steering.device import SteeringInput
from farhand.runs.scenario import load_scenario, replace_setting
from farhand.testing import (
    OPERATOR_SESSION,
    ROBOT_SESSION,
    ScriptedController,
    ScriptedDevice,
    ScriptedLink,
    description,
    echo_of,
    scene,
    state,
)

MS = 1_000_000
P = 100 * MS
ME, ROBOT = OPERATOR_SESSION, ROBOT_SESSION
ZERO = (0.0, 0.0, 0.0)
FORWARD = (0.2, 0.0, 0.0)


class Bench:
    """A node, its link to the test, and the commands that left."""

    def __init__(self, controller=None, **settings):
        scenario = load_scenario("point-obstacle")
        for key, value in ({"controller.kind": "pass-through"} | settings).items():
            scenario = replace_setting(scenario, key, value)
        self.link, self.device = ScriptedLink("r"), ScriptedDevice(FORWARD)
        controller = controller or make_controller(scenario.controller)
        self.node = OperatorNode(scenario, controller, self.device, self.link, OperatorIdentity("r", ME))
        self.now = 5_000 * MS
        self.seqs, self.scene_seqs, self.described = (itertools.count() for _ in range(3))
        self.sent = []

    def robot(self, echoed=None, applied=None, at_ns=None, **changes):
        """The robot sends a state that echoes one of our commands, and arrives at `at_ns`: now."""
        fields = {
            "seq": next(self.seqs), "t_sent_ns": 77, "position": (0.6, 0.0, 0.6),
            "echo": None if echoed is None else echo_of(echoed),
            "applied_session": 0 if applied is None else ME, "applied_seq": 0 if applied is None else applied.seq,
        } | changes  # fmt: skip
        self.link.feed(state(**fields), self.now if at_ns is None else at_ns)

    def scene(self, *obstacles):
        """The robot says what is around it, and what it is."""
        self.describe()
        self.link.feed(scene(next(self.scene_seqs), *obstacles, t_sent_ns=77), self.now)

    def describe(self, **changes):
        self.link.feed(description(next(self.described), t_sent_ns=77, **changes), self.now)

    def tick(self, late_ns=0):
        """The next tick; returns the command that left, or None."""
        now = self.link.now_ns = self.now + late_ns
        self.now = self.node.step(now)
        commands = self.link.take()
        assert len(commands) <= 1
        if not commands:
            return None
        assert self.link.sent[-1].key == "farhand/r/command"
        (command,) = commands
        assert command.t_sent_ns == now
        self.sent.append(command)
        return command

    def drive(self):
        """Until the first `run` command, which is returned."""
        self.robot(holder=0, mode="hold")
        self.scene()
        asking = self.tick()
        assert asking.mode == "acknowledge"
        self.robot(asking, mode="hold", applied=asking)
        command = self.tick()
        assert command.mode == "run"
        return command


def test_nothing_is_sent_before_state_scene_and_description_are_there():
    bench = Bench()
    assert bench.tick() is None
    assert bench.node.report.stop_reason == "no state from the robot yet"
    bench.robot(holder=0)
    assert bench.tick() is None
    assert bench.node.report.stop_reason == "no scene from the robot yet"
    assert bench.node.report.safety == "run"
    bench.link.feed(scene(0, t_sent_ns=77), bench.now)
    assert bench.tick() is None
    assert bench.node.report.stop_reason == "no description from the robot yet"
    bench.describe()
    assert bench.tick().mode == "acknowledge"
    assert bench.node.driving_since_ns is None


def test_it_asks_for_control_and_then_drives():
    bench = Bench()
    command = bench.drive()
    assert command.velocity == FORWARD
    assert command.desired == FORWARD
    assert command.echo == Echo(ROBOT, 1, 77, 0)
    assert command.plan_period_ns == P
    assert len(command.plan) == 9
    assert bench.node.driving_since_ns == command.t_sent_ns
    report = bench.node.report
    assert (report.mode, report.stop_reason, report.target_index, report.target_count) == ("run", "", 0, 0)
    assert report.rtt == pytest.approx(0.1)  # the answer came with the next tick
    assert report.clearance == 1.0
    assert report.tick == 1


@pytest.mark.parametrize("kind", ["pass-through", "one-step"])
def test_who_filters_nothing_is_not_helped_out_of_a_margin(kind):
    bench = Bench(**{"controller.kind": kind, "margin.kind": "none"})
    asking = bench.drive()
    bench.robot(asking, applied=asking)
    bench.scene(Obstacle("ball", (0.75, 0.0, 0.6), 0.1))  # it is asked to go on into what it overlaps
    helped = bench.tick().velocity != FORWARD
    assert helped == (kind != "pass-through")


def test_the_report_knows_the_round_trip():
    bench = Bench()
    command = bench.drive()
    bench.robot(echo=echo_of(command, hold_ns=15 * MS), at_ns=command.t_sent_ns + 60 * MS)
    assert bench.tick().t_sent_ns == command.t_sent_ns + 100 * MS
    assert bench.node.report.rtt == pytest.approx(0.045)
    assert bench.node.report.state_age == pytest.approx(0.040)


def test_the_report_counts_what_a_state_was_old_already_when_it_was_sent():
    bench = Bench()
    command = bench.drive()
    sent_ns = command.t_sent_ns + 60 * MS
    bench.robot(echo=echo_of(command), at_ns=sent_ns, t_sent_ns=sent_ns, t_sample_ns=sent_ns - 1500 * MS)
    bench.tick()
    assert bench.node.report.state_age == pytest.approx(1.540)


def test_missed_ticks_use_up_sequence_numbers():
    bench = Bench()
    first = bench.drive()
    bench.robot(first)
    late = bench.tick(late_ns=250 * MS)
    assert late.seq == first.seq + 3
    assert bench.node.report.overruns == 2
    bench.robot(late)
    assert bench.tick().seq == late.seq + 1
    assert bench.node.report.overruns == 2


def test_silence_beyond_the_limit_sends_zeros_until_the_robot_answers():
    bench = Bench()
    command = bench.drive()
    bench.robot(command)
    commands = [bench.tick() for _ in range(13)]
    speeds = [c.velocity for c in commands]
    assert speeds[:9] == [FORWARD] * 9  # the first of them is 0.8 s old in the ninth tick after it
    assert speeds[9:] == [ZERO] * 4
    assert [c.plan for c in commands[9:]] == [(ZERO,) * 9] * 4
    assert {c.mode for c in commands} == {"run"}
    assert bench.node.report.stop_reason == STALE_STATE
    bench.robot(commands[-1])
    assert bench.tick().velocity == FORWARD
    assert bench.node.report.stop_reason == ""


def test_without_the_adaptive_margin_there_is_no_resynchronising():
    bench = Bench(**{"margin.kind": "paper"})
    bench.drive()
    assert [bench.tick().velocity for _ in range(15)] == [FORWARD] * 15


def test_while_another_one_holds_control_it_only_asks_once_a_second():
    bench = Bench()
    command = bench.drive()
    bench.robot(command, holder=ME + 1, holder_name="eve")
    asked = [bench.tick() for _ in range(12)]
    assert [k for k, c in enumerate(asked) if c is not None] == [0, 10]
    assert {(c.mode, c.velocity, c.source) for c in asked if c} == {("acknowledge", ZERO, "operator")}
    assert bench.node.report.mode == "hold"
    assert bench.node.report.stop_reason.startswith("eve holds control; waiting")
    assert bench.node.round_trip.age(bench.now) == 0.0  # nothing answers who asks
    bench.robot(command, holder=0, lease_end="released")
    assert bench.tick().mode == "acknowledge"


def test_control_is_handed_over_to_whom_it_is_told():
    bench = Bench()
    command = bench.drive()
    bench.robot(command, waiting=((ME + 1, "eve"),))
    bench.node.hand_over(ME + 1)
    given = bench.tick()
    assert (given.mode, given.successor, given.velocity) == ("release", ME + 1, ZERO)
    assert bench.node.successor == ME + 1
    bench.robot(command, holder=ME + 1, holder_name="eve")
    assert bench.tick().mode == "acknowledge"
    assert (bench.node.successor, bench.node.report.source) == (0, "operator")


def test_a_device_let_go_holds_and_an_emergency_stop_stops():
    bench = Bench()
    bench.robot(bench.drive())
    bench.device.wants = SteeringInput(FORWARD, engaged=False)
    held = bench.tick()
    assert (held.mode, held.velocity) == ("hold", ZERO)
    assert held.plan == (ZERO,) * 9
    bench.device.wants = SteeringInput(FORWARD, engaged=True, estop=True)
    assert (bench.tick().mode, bench.sent[-1].velocity) == ("estop", ZERO)


def test_a_stopped_robot_gets_a_hold_or_the_acknowledgement():
    bench = Bench()
    command = bench.drive()
    bench.robot(command, mode="stopped", reason="no good command for 2 s")
    assert bench.tick().mode == "hold"
    assert bench.node.report.stop_reason == "robot stopped: no good command for 2 s"
    bench.device.wants = SteeringInput(FORWARD, engaged=True, acknowledge=True)
    assert bench.tick().mode == "acknowledge"


def test_release_is_the_last_word():
    bench = Bench()
    command = bench.drive()
    bench.node.release(bench.now)
    (last,) = bench.link.take()
    assert (last.mode, last.velocity, last.plan, last.seq) == ("release", ZERO, (), command.seq + 1)


def test_late_and_broken_messages_do_not_disturb_it():
    bench = Bench()
    command = bench.drive()
    bench.robot(command)
    bench.robot(command, seq=0, position=(9.0, 9.0, 9.0))
    for payload in (b"", b"junk", b"\x00" * 2_000_000):
        bench.link.feed(payload, bench.now, "farhand/r/state")
    bench.link.feed(b"junk", bench.now, "farhand/elsewhere/state")
    assert bench.tick().velocity == FORWARD
    report = bench.node.report
    assert report.refused_here == 3
    assert report.position == (0.6, 0.0, 0.6)


@pytest.mark.parametrize("status", [Status.FAILED, Status.BAD_INPUT])
def test_a_solver_that_fails_stands_still_and_says_so(status):
    bench = Bench(ScriptedController(status=status), **{"controller.kind": "mpc-cbf"})
    assert bench.drive().velocity == ZERO
    assert bench.node.report.status == status.value
    assert bench.node.report.stop_reason != ""
    assert bench.node.report.intervening


def test_the_obstacles_are_those_of_the_wire_and_the_newest_of_them():
    controller = ScriptedController()
    margin = {"margin.adaptive.floor": 0.02, "margin.adaptive.least": 0.02}
    bench = Bench(controller, **{"controller.kind": "mpc-cbf", "controller.d_min": 0.01, **margin})
    bench.drive()
    assert controller.problems[-1].radii.shape == (0,)  # the scenario has two; the wire says none
    bench.scene(Obstacle("ball", (3.0, 0.0, 0.0), 0.5))
    bench.robot(bench.sent[-1])
    bench.tick()
    problem = controller.problems[-1]
    assert problem.centres.tolist() == [[3.0, 0.0, 0.0]]
    assert problem.radii.tolist() == pytest.approx([0.5 + 0.1 + 0.01 + 0.02], abs=5e-4)
    lag_part = bench.node.report.margin_parts["lag"]
    assert problem.radii[0] - 0.63 == pytest.approx(lag_part)
    assert bench.node.report.inflation == pytest.approx(0.02 + lag_part)


def test_moving_obstacles_are_taken_to_where_they_will_be():
    controller = ScriptedController()
    bench = Bench(controller, **{"controller.kind": "mpc-cbf", "operator.predictor": "last-command"})
    bench.drive()
    bench.scene(Obstacle("ball", (3.0, 0.0, 0.0), 0.5, (0.0, 1.0, 0.0)))
    bench.robot(bench.sent[-1], t_sample_ns=77 + 300 * MS)
    bench.tick()
    look = bench.node.round_trip.mean
    expected = 0.3 + look + 0.1
    assert controller.problems[-1].centres[0].tolist() == pytest.approx([3.0, expected, 0.0])


def test_silence_forgets_the_warm_start():
    controller = ScriptedController()
    bench = Bench(controller, **{"controller.kind": "mpc-cbf"})
    bench.drive()
    for _ in range(12):
        bench.tick()
    assert controller.resets > 0


@pytest.mark.parametrize(("predictor", "held"), [("timeline", False), ("echo", False), ("history", True)])
def test_laws_that_do_not_know_the_plan_hold_the_first_velocity(predictor, held):
    slowing = [(0.3, 0.0, 0.0)] + [(0.15, 0.0, 0.0)] * 9
    bench = Bench(
        ScriptedController(np.array(slowing)),
        **{"controller.kind": "mpc-cbf", "operator.predictor": predictor},
    )
    command = bench.drive()
    assert command.velocity == pytest.approx((0.3, 0.0, 0.0))
    assert command.plan[-1] == pytest.approx((0.3 if held else 0.15, 0.0, 0.0))


def test_every_tick_is_recorded_with_what_arrived():
    class Keeping:
        def __init__(self):
            self.ticks = []

        def tick(self, *what):
            self.ticks.append(what)

    bench = Bench()
    bench.node.recorder = Keeping()
    bench.tick()
    bench.drive()
    (silent, asking, driving) = bench.node.recorder.ticks
    assert silent[1:3] == ([], None)
    assert [p.key for p in asking[1]] == ["farhand/r/state", "farhand/r/description", "farhand/r/scene"]
    assert driving[2] == encode(bench.sent[-1])
    assert driving[3] == bench.node.report
    assert msgspec.structs.asdict(driving[3])["mode"] == "run"


def test_another_robot_is_predicted_as_it_says_it_is():
    """A robot that comes back with another lag: the plan begins where that one will be."""
    bench = Bench()
    command = bench.drive()
    for lag in (0.1, 0.3, 0.3):
        bench.describe(lag=lag)
        bench.robot(command, velocity=(0.2, 0.0, 0.0))
        command = bench.tick()
        assert bench.node.robot.lag == lag
        assert bench.node.report.predicted == pytest.approx((0.6 + lag * 0.2, 0.0, 0.6))


def test_the_sphere_around_the_tool_is_the_robots():
    ball = Obstacle("ball", (1.2, 0.0, 0.6), 0.1)
    clear = {}
    for radius in (0.1, 0.45):
        bench = Bench(**{"controller.kind": "mpc-cbf"})
        bench.scene(ball)
        bench.describe(radius=radius)
        bench.robot(holder=0, mode="hold")
        bench.robot(bench.tick(), mode="hold")
        clear[radius] = bench.tick().velocity[0]
    assert clear[0.45] < clear[0.1] - 0.05


def test_a_target_that_another_operator_reaches_is_none_of_ours():
    bench = Bench()
    bench.robot(holder=ME + 1, holder_name="other", position=(1.0, 0.0, 0.6))
    bench.describe()
    bench.link.feed(scene(0, targets=((1.0, 0.0, 0.6),), t_sent_ns=77), bench.now)
    bench.tick()
    assert bench.node.waits
    assert (bench.node.report.target_index, bench.node.finished) == (0, False)
    bench.robot(holder=ME, position=(1.0, 0.0, 0.6))
    bench.tick()
    assert bench.node.finished
