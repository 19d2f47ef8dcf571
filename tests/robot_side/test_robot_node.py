"""The robot's node over in-memory links and virtual time."""

import json
import math

import msgspec
import pytest

from farhand.common.messages.base import SCHEMA
from farhand.common.messages.scene import Obstacle
from farhand.robot_side.robot_node import RobotNode
from farhand.robot_side.robots.point import PointRobot
from farhand.robot_side.robots.registry import make_robot
from farhand.robot_side.scene.obstacle_field import ObstacleField
from farhand.runs.scenario import load_scenario
from farhand.testing import ScriptedLink, ScriptedRobot, command, echo_of

SESSION = 1234
SECOND = 1_000_000_000
SCENARIO = load_scenario("point-obstacle")


class Bench:
    """A node, its link to the test, and what came out."""

    def __init__(self, scenario=SCENARIO, robot=None):
        self.link = ScriptedLink("r1")
        self.node = RobotNode(scenario, robot or make_robot(scenario), self.link, "r1", SESSION)
        self.now = 7 * SECOND
        self.states, self.scenes, self.descriptions = [], [], []
        self.seq = 0

    def tick(self, n=1):
        for _ in range(n):
            self.link.now_ns = self.now
            self.now = self.node.step(self.now)
            self.states += self.link.take("state")
            self.scenes += self.link.take("scene")
            self.descriptions += self.link.take("description")

    def command(self, velocity=(0.2, 0.0, 0.0), mode="run", **changes):
        """The next command, built on the newest state."""
        self.seq += 1
        echo = echo_of(self.states[-1]) if self.states else None
        return command(self.seq, mode, **({"velocity": velocity, "echo": echo} | changes))

    def send(self, what, key="farhand/r1/command"):
        self.link.feed(what, self.now, key)


def test_good_command_moves_the_robot_and_is_shown():
    bench = Bench()
    bench.tick(2)
    assert bench.states[-1].holder == 0
    bench.send(bench.command(plan=((0.2, 0.0, 0.0),) * 9))
    bench.tick(26)
    state = bench.states[-1]
    assert (state.mode, state.holder, state.applied_session, state.applied_seq) == ("hold", 7, 7, 1)
    assert state.applied_for_ns == 25 * 20_000_000
    assert state.velocity[0] == pytest.approx(0.2, rel=0.01)
    assert (state.echo.session, state.echo.seq, state.echo.hold_ns) == (7, 1, state.applied_for_ns)
    # position lag of a first-order plant: u (t - lag)
    assert state.position[0] - 0.6 == pytest.approx(0.2 * (0.5 - 0.1), abs=2e-4)


def test_unfed_run_plays_its_plan_then_stands():
    bench = Bench()
    bench.tick()
    bench.send(bench.command(plan=((0.0, 0.0, 0.3),)))
    bench.tick(60)
    end = bench.states[-1].position
    assert end[0] - 0.6 == pytest.approx(0.02, abs=1e-4)
    assert end[2] - 0.6 == pytest.approx(0.03, abs=1e-4)


@pytest.mark.parametrize("payload", [b"", b"\x00" * 50, b"\xff\xfe", b"\x81\xa1a" * 100, b"x" * (1 << 21)])
def test_garbage_is_counted_and_moves_nothing(payload):
    bench = Bench()
    bench.tick()
    bench.send(payload)
    bench.tick()
    assert sum(bench.states[-1].refused.values()) == 1
    assert bench.states[-1].position == SCENARIO.start


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"velocity": (math.nan, 0.0, 0.0)}, "non-finite"),
        ({"velocity": (math.inf, 0.0, 0.0)}, "non-finite"),
        ({"velocity": (0.0, 0.0)}, "length"),
        ({"plan": ((0.0, math.nan, 0.0),)}, "non-finite"),
        ({"schema": SCHEMA + 1}, "schema"),
        ({"echo": None}, "no-echo"),
    ],
)
def test_malformed_command_is_counted_by_reason(change, reason):
    bench = Bench()
    bench.tick()
    fields = msgspec.to_builtins(bench.command()) | change
    bench.send(msgspec.msgpack.encode(fields))
    bench.tick()
    assert bench.states[-1].refused == {reason: 1}
    assert bench.states[-1].holder == 0


def test_burst_of_old_commands_after_an_outage_moves_nothing():
    bench = Bench()
    bench.tick(2)
    bench.send(bench.command())
    bench.tick(5)
    held_back = [bench.command(velocity=(0.5, 0.0, 0.5)) for _ in range(40)]
    bench.tick(100)
    before = bench.states[-1].position
    for old in held_back:
        bench.send(old)
    bench.tick(20)
    assert bench.states[-1].mode == "stopped"
    assert bench.states[-1].refused == {"stale": 40}
    assert bench.states[-1].position == pytest.approx(before, abs=1e-7)


def test_foreign_sessions_never_enter_the_echo():
    bench = Bench()
    bench.tick()
    bench.send(bench.command(session=7))
    bench.tick()
    bench.send(bench.command(session=8))
    bench.tick()
    assert bench.states[-1].echo.session == 7
    assert bench.states[-1].refused == {"foreign-session": 1}


def test_flood_costs_a_bounded_number_of_decodes_and_keeps_the_newest():
    bench = Bench()
    bench.tick()
    for _ in range(1000):
        bench.send(bench.command())
    bench.tick()
    assert bench.states[-1].refused == {"flood": 744}
    assert bench.states[-1].applied_seq == 1000
    assert bench.node.intake.received == 256


def test_other_keys_are_not_commands():
    bench = Bench()
    bench.tick()
    bench.send(bench.command(), key="farhand/r2/command")
    bench.tick()
    assert bench.states[-1].holder == 0
    assert bench.states[-1].refused == {}


@pytest.mark.parametrize("call", ["sample", "step", "arm_clearance"])
@pytest.mark.parametrize("times", [1, 10**9])
def test_any_exception_stops_the_robot_and_states_go_on(call, times):
    robot = ScriptedRobot(SCENARIO.start)
    bench = Bench(robot=robot)
    bench.tick(2)
    bench.send(bench.command())
    bench.tick()
    robot.fail(call, times)
    sent = len(bench.states)
    bench.tick()
    robot.told.clear()
    for _ in range(20):
        bench.send(bench.command())
        bench.tick()
    assert len(bench.states) == sent + 21
    assert bench.states[-1].mode == "stopped"
    assert bench.states[-1].reason == "fault: RuntimeError: gearbox"
    assert {velocity for velocity, _ in robot.told} <= {(0.0, 0.0, 0.0)}
    assert bool(robot.told) == (call != "step" or times == 1)
    assert bench.states[-1].stops == 1


def test_state_that_is_not_finite_is_a_fault():
    robot = ScriptedRobot(SCENARIO.start)
    bench = Bench(robot=robot)
    bench.tick(2)
    robot.show(velocity=(math.nan, 0.0, 0.0))
    bench.tick(2)
    assert bench.states[-1].reason.startswith("fault: ")
    assert bench.states[-1].velocity == (0.0, 0.0, 0.0)


def test_missed_ticks_are_made_good():
    punctual, late = Bench(), Bench()
    for bench in (punctual, late):
        bench.tick()
        bench.send(bench.command(plan=((0.2, 0.0, 0.0),) * 9))
        bench.tick()
    punctual.tick(5)
    late.now += 4 * 20_000_000
    late.tick()
    assert late.states[-1].position == pytest.approx(punctual.states[-1].position, abs=1e-12)
    assert late.node.summary().overruns == 4
    assert late.node.summary().ticks == punctual.node.summary().ticks


def test_hardware_is_not_stepped_for_ticks_that_were_missed():
    """Its time went on meanwhile: the missed steps would reach it in one burst."""

    class Hardware(PointRobot):
        catches_up = False

    bench = Bench(robot=Hardware(SCENARIO.start, 0.1))
    bench.tick()
    bench.send(bench.command(plan=((0.2, 0.0, 0.0),) * 9))
    bench.tick()
    bench.now += 4 * 20_000_000
    bench.tick()
    assert bench.node.summary().overruns == 4
    assert bench.node.summary().ticks == 3


def test_early_wake_up_does_nothing():
    bench = Bench()
    bench.tick()
    assert bench.node.step(bench.now - 1) == bench.now
    assert bench.node.summary().ticks == 1


def test_scene_once_a_second_on_a_new_holder_and_on_change():
    bench = Bench()
    bench.tick(101)
    assert len(bench.scenes) == 3
    assert bench.scenes[0].obstacles == SCENARIO.obstacles
    assert bench.scenes[0].targets == SCENARIO.targets
    told = bench.descriptions[0]
    assert (told.kind, told.radius, told.lag) == ("point", SCENARIO.robot.radius, SCENARIO.robot.lag)
    assert (told.max_speed, told.max_age) == (SCENARIO.safety.max_speed, SCENARIO.safety.max_age)
    bench.send(bench.command())
    bench.tick()
    assert len(bench.scenes) == 4
    bench.node.replace_obstacles([Obstacle("new", (1.0, 1.0, 1.0), 0.1)], bench.now)
    bench.tick()
    assert [o.id for o in bench.scenes[-1].obstacles] == ["new"]
    assert [scene.seq for scene in bench.scenes] == list(range(5))
    assert [told.seq for told in bench.descriptions] == list(range(5))
    assert all(told.same_robot(bench.descriptions[0]) for told in bench.descriptions)


def test_clearance_follows_moving_obstacles():
    mover = Obstacle("mover", (2.6, 0.0, 0.6), 0.3, (-0.5, 0.0, 0.0))
    scenario = msgspec.structs.replace(SCENARIO, obstacles=(mover,))
    bench = Bench(scenario)
    bench.tick(101)
    assert bench.states[-1].clearance == pytest.approx(2.0 - 0.3 - 0.1837 - 0.5 * 2.0, abs=1e-9)
    assert bench.scenes[-1].obstacles[0].position == pytest.approx((1.6, 0.0, 0.6), abs=1e-9)
    assert bench.scenes[-1].t_sample_ns == 9 * SECOND


def test_clearance_by_loop_and_by_numpy_agree():
    few = [Obstacle(f"o{k}", (0.1 * k, 1.0, -0.2 * k), 0.05, (0.01 * k, 0.0, 0.1)) for k in range(24)]
    far = Obstacle("far", (90.0, 0.0, 0.0), 0.1)
    point = (0.7, 0.3, -1.0)
    by_loop = ObstacleField(few, 0).clearance(point, 0.2, 3 * SECOND)
    by_numpy = ObstacleField([*few, far], 0).clearance(point, 0.2, 3 * SECOND)
    nearest = min(
        math.dist(point, [p + 3 * v for p, v in zip(o.position, o.velocity, strict=True)]) - 0.05 for o in few
    )
    assert by_loop == pytest.approx(nearest - 0.2, abs=1e-12)
    assert by_numpy == pytest.approx(by_loop, abs=1e-12)
    assert ObstacleField([], 0).clearance(point, 0.2, 0) == 1e6


def test_summary_is_json_and_holds_the_worst_clearance():
    bench = Bench()
    bench.tick()
    for _ in range(150):
        bench.send(bench.command(velocity=(0.5, 0.0, 0.5 * 1.25 / 1.7)))
        bench.tick()
    summary = json.loads(msgspec.json.encode(bench.node.summary()))
    assert summary["min_clearance"] < 1.0
    assert summary["min_clearance"] == min(state.clearance for state in bench.states)
    assert summary["path_length"] == pytest.approx(math.dist(bench.states[-1].position, SCENARIO.start))
    assert [change[1] for change in summary["changes"]] == ["run"]
    t, x, y, z, clearance = bench.node.trajectory[-1]
    assert t == pytest.approx(3.0)
    assert ((x, y, z), clearance) == (bench.states[-1].position, bench.states[-1].clearance)


class Blocked(PointRobot):
    """Says that it is stopped for as long as `why` says something; remembers how fast it was asked to go."""

    why, asked = "", ()

    def stopped_by(self):
        return self.why

    def step(self, twist, dt, surroundings=None):
        self.asked = (*self.asked, max(map(abs, twist.linear)))
        super().step(twist, dt, surroundings)


def test_a_robot_that_says_that_it_is_stopped_is_asked_for_nothing_until_that_is_over_and_acknowledged():
    robot = Blocked.for_scenario(SCENARIO)
    bench = Bench(robot=robot)
    bench.tick(60)

    def send(mode):
        bench.send(bench.command((0.2 if mode == "run" else 0.0, 0.0, 0.0), mode))
        bench.tick(5)

    send("acknowledge")
    send("run")
    assert bench.states[-1].mode == "run"
    assert max(robot.asked) > 0.0
    robot.why = "protective stop: look why"
    bench.tick(200)  # long enough to stand
    assert (bench.states[-1].mode, bench.states[-1].reason) == ("stopped", robot.why)
    robot.asked = ()
    for mode in ("run", "acknowledge", "run"):
        send(mode)
    assert (bench.states[-1].mode, max(robot.asked)) == ("stopped", 0.0)
    robot.why = ""
    send("run")
    assert (bench.states[-1].mode, max(robot.asked)) == ("stopped", 0.0)
    send("acknowledge")
    send("run")
    assert bench.states[-1].mode == "run"
    assert max(robot.asked) > 0.0


def test_what_a_silent_controller_said_last_is_not_stamped_as_new():
    """The robot's program lives and sends; what it knows of the arm is two seconds old all the same."""
    robot = make_robot(SCENARIO)
    bench = Bench(robot=robot)
    bench.tick(2)
    assert bench.states[-1].sample_age == 0.0
    robot.sample_age = 2.0
    bench.tick()
    state = bench.states[-1]
    assert state.sample_age == pytest.approx(2.0)
    assert state.t_sample_ns == state.t_sent_ns - 2 * SECOND
    assert state.applied_for_ns == 0
