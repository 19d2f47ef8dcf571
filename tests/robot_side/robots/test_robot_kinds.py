"""The robots behind one interface: the box's and the point's dynamics, determinism, silence, the program."""

import hashlib
import json
import math
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

from farhand.common.geometry import Twist
from farhand.common.result_file import write_result
from farhand.common.timing.clock import SystemClock
from farhand.robot_side.main import run_robot
from farhand.robot_side.robot_node import RobotNode
from farhand.robot_side.robots.point import PointRobot
from farhand.robot_side.robots.pybullet_box import SIZE, BoxRobot
from farhand.robot_side.robots.registry import make_robot
from farhand.runs.scenario import load_scenario
from farhand.testing import ScriptedLink, command, echo_of

ROOT = Path(__file__).parents[3]
DT = 0.002


@pytest.fixture
def box():
    box = BoxRobot((1.0, 0.0, 2.0))
    yield box
    box.close()


def test_box_follows_with_a_tenth_of_a_second(box):
    speeds = []
    for _ in range(1000):
        box.step(Twist((0.0, 0.3, -0.4)), DT)
        speeds.append(np.linalg.norm(box.sample().velocity))
    assert np.argmax(np.array(speeds) >= 0.632 * 0.5) * DT == pytest.approx(0.1, abs=0.004)
    assert max(speeds) <= 0.5 + 1e-9
    assert box.sample().velocity == pytest.approx((0.0, 0.3, -0.4), abs=1e-6)
    travelled = np.array(box.sample().position) - (1.0, 0.0, 2.0)
    assert travelled == pytest.approx(np.array((0.0, 0.3, -0.4)) * (2.0 - 0.098), abs=1e-4)


def test_box_hovers_without_drift(box):
    for _ in range(5000):
        box.step(Twist((0.0, 0.0, 0.0)), DT)
    assert box.sample().position == pytest.approx((1.0, 0.0, 2.0), abs=1e-9)


def test_box_rights_itself(box):
    bullet, client = box._bullet, box._client
    bullet.resetBaseVelocity(box._body, (0, 0, 0), (1.0, -2.0, 0.5), physicsClientId=client)
    box._read()
    largest = 0.0
    for _ in range(1000):
        box.step(Twist((0.0, 0.0, 0.0)), DT)
        largest = max(largest, 1.0 - box.sample().orientation[0])
    assert largest > 1e-5
    assert box.sample().orientation == pytest.approx((1.0, 0.0, 0.0, 0.0), abs=1e-6)


def test_box_turns_as_commanded_and_keeps_the_attitude(box):
    for _ in range(500):
        box.step(Twist(angular=(0.6, 0.0, 0.8)), DT)
    assert box.sample().angular_velocity == pytest.approx((0.6, 0.0, 0.8), abs=1e-3)
    for _ in range(1000):
        box.step(Twist(), DT)
    half = 0.5  # rad: 1 rad/s for 1 s
    turned = (math.cos(half), 0.6 * math.sin(half), 0.0, 0.8 * math.sin(half))
    assert box.sample().orientation == pytest.approx(turned, abs=1e-4)
    assert box.sample().angular_velocity == pytest.approx((0.0, 0.0, 0.0), abs=1e-4)
    assert box.sample().position == pytest.approx((1.0, 0.0, 2.0), abs=1e-9)


def test_box_scenario_uses_the_box_of_the_paper():
    scenario = load_scenario("box-obstacle")
    assert scenario.robot.radius == pytest.approx(np.linalg.norm(SIZE) / 2, abs=1e-4)
    assert scenario.controller.speed_limit == (0.5, 0.5, 0.5)
    assert scenario.margin.own["paper"] == {"max_speed": 0.87}
    assert {p[1] for p in (scenario.start, *scenario.targets)} == {0.0}


def test_point_is_exact_at_any_period():
    fine, coarse = PointRobot((0.0, 0.0, 0.0), 0.1), PointRobot((0.0, 0.0, 0.0), 0.1)
    for _ in range(100):
        fine.step(Twist((0.3, -0.1, 0.2)), 0.002)
    coarse.step(Twist((0.3, -0.1, 0.2)), 0.2)
    assert fine.sample().position == pytest.approx(coarse.sample().position, abs=1e-14)
    assert fine.sample().velocity[0] == pytest.approx(0.3 * (1 - np.exp(-2)), abs=1e-14)


def test_point_turns_with_its_lag():
    point = PointRobot((0.0, 0.0, 0.0), 0.1)
    for _ in range(1000):
        point.step(Twist(angular=(0.0, 0.0, 0.5)), 0.002)
    assert point.sample().angular_velocity == pytest.approx((0.0, 0.0, 0.5), abs=1e-6)
    angle = 0.5 * (2.0 - 0.1)
    assert point.sample().orientation == pytest.approx((math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2)))
    assert point.sample().position == (0.0, 0.0, 0.0)


def test_point_without_lag_follows_at_once():
    point = PointRobot((0.0, 0.0, 0.0), 0.0)
    point.step(Twist((1.0, 0.0, 0.0)), 0.1)
    assert point.sample().velocity == (1.0, 0.0, 0.0)
    assert point.sample().position == pytest.approx((0.1, 0.0, 0.0))


WANDER = """
import hashlib, sys
from farhand.common.geometry import Twist
from farhand.runs.scenario import load_scenario
from farhand.common.seeds import stream
from farhand.robot_side.robots.registry import make_robot
scenario = load_scenario(sys.argv[1])
robot = make_robot(scenario)
rng, digest = stream(5, "wander"), hashlib.sha256()
for _ in range(10):
    velocity = tuple(rng.uniform(-0.2, 0.2, 3).tolist())
    for _ in range(50):
        robot.step(Twist(velocity), 1 / scenario.robot.rate_hz)
        digest.update(repr((robot.sample(), robot.arm_clearance(scenario.obstacles))).encode())
robot.close()
print(digest.hexdigest())
"""


@pytest.mark.parametrize("scenario", ["ur5-obstacle", "box-obstacle"])
def test_a_fresh_process_agrees_with_this_one_to_the_bit_and_prints_nothing_else(
    scenario, monkeypatch, capsys
):
    fresh = subprocess.run(
        [sys.executable, "-c", WANDER, scenario], cwd=ROOT, capture_output=True, text=True, check=True
    )
    monkeypatch.setattr("sys.argv", ["-c", scenario])
    exec(WANDER, {})
    assert fresh.stdout == capsys.readouterr().out
    assert len(fresh.stdout.strip()) == len(hashlib.sha256().hexdigest())
    assert fresh.stderr == ""


@pytest.mark.parametrize("name", ["ur5-obstacle", "box-obstacle", "point-obstacle"])
def test_every_kind_is_made_moves_and_closes(name):
    scenario = load_scenario(name)
    robot = make_robot(scenario)
    assert robot.sample().position == pytest.approx(scenario.start, abs=1e-6)
    for _ in range(100):
        robot.step(Twist((0.0, 0.1, 0.0)), 1 / scenario.robot.rate_hz)
    assert robot.sample().position[1] > scenario.start[1] + 0.005
    robot.close()


def test_program_runs_until_told_and_writes_its_summary(tmp_path):
    """Its first states are answered with run commands, and after the tenth it is told to end."""
    stop, states = threading.Event(), []

    def answer(packet):
        states.extend(link.take("state"))
        link.feed(command(states[-1].seq, echo=echo_of(states[-1])), at_ns=0)
        if len(states) == 10:
            stop.set()

    link = ScriptedLink("r1", on_send=answer)
    file = tmp_path / "robot.json"
    scenario = load_scenario("point-obstacle")
    node = RobotNode(scenario, make_robot(scenario), link, "r1", 9)
    summary = run_robot(node, SystemClock(), stop, realtime=False)
    write_result(summary, file)
    assert len(states) == 10
    assert states[-1].mode == "run"
    written = json.loads(file.read_text())
    assert written["mode"] == summary.mode == "run"
    assert len(written["trajectory"]) == written["ticks"] >= 10  # a late tick makes good for what was missed
    assert states[0].session != 0
