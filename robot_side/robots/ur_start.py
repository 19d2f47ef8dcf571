"""What is looked at before a real UR arm may be driven from where it stands."""

import dataclasses
from types import SimpleNamespace
from typing import cast

import msgspec
import numpy as np

from farhand.common.errors import InputError, ScenarioError
from farhand.common.geometry import Array
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.robot_side.arm.model import ArmModel
from farhand.robot_side.robots.arms import chosen_arm
from farhand.robot_side.robots.settings import RobotScenario
from farhand.robot_side.ur import poses
from farhand.robot_side.ur.dashboard import Dashboard, DashboardError
from farhand.robot_side.ur.link import UrLink
from farhand.robot_side.ur.program import fastest_joint
from farhand.robot_side.ur.settings import UrSettings
from farhand.robot_side.ur.states import PLAYING, Facts

PATIENCE = 4.0
"""s until the controller must have answered."""
POLL = 0.002
SAME_PLACE = 0.02
"""m between the tool as the controller has it and by the scenario's model; arms of one model differ by some mm."""
SAME_PAYLOAD = 0.005
"""kg."""


def first_facts(scenario: RobotScenario, link: UrLink, settings: UrSettings, clock: SystemClock) -> Facts:
    """The controller's first state; raises InputError where there is none, or it must not be driven."""
    host = scenario.robot.host or ""
    end_ns = clock.now_ns() + to_ns(PATIENCE)
    while True:
        now_ns = clock.now_ns()
        facts = link.poll(now_ns, starts=False)
        if facts.values and not facts.trouble:
            break
        if now_ns > end_ns:
            raise InputError(
                f"robot.host {host}: {facts.trouble}; farhand ur check --host {host} looks closer"
            )
        clock.sleep_until(now_ns + to_ns(POLL))
    _check_model(scenario, facts, host)
    _check_payload(settings, facts)
    if int(facts.values["runtime_state"]) == PLAYING:
        raise InputError(
            f"robot.host {host}: another program runs on the controller; end it at the pendant, or whoever runs it"
        )
    return facts


def at_its_rate(scenario: RobotScenario, rate_hz: float) -> RobotScenario:
    """The same scenario, the robot stepped as often as its controller takes speeds."""
    robot = msgspec.structs.replace(scenario.robot, rate_hz=rate_hz)
    names = ("name", "start", "targets", "obstacles", "safety", "guard")
    view = SimpleNamespace(robot=robot, **{name: getattr(scenario, name) for name in names})
    return cast(RobotScenario, view)


def slower_arm(arm: ArmModel, settings: UrSettings, step: float) -> ArmModel:
    """The arm, its joints no faster than the deadline can bring them to a stand in time."""
    least = float(arm.max_acceleration.min())
    fastest = fastest_joint(settings, step, least)
    return dataclasses.replace(arm, max_velocity=np.minimum(arm.max_velocity, fastest))


def check_joints(scenario: RobotScenario, q: Array) -> None:
    """Raise ScenarioError where a joint stands outside of the limits that Farhand keeps."""
    arm = chosen_arm(scenario.robot)
    for name, angle, low, high in zip(arm.joint_names, q, arm.lower, arm.upper, strict=True):
        if not low <= angle <= high:
            raise ScenarioError(
                f"scenario {scenario.name}: {name} stands at {angle:.3f} rad, outside of {low:.3f} to {high:.3f}; move "
                "it there at the pendant"
            )


def _check_model(scenario: RobotScenario, facts: Facts, host: str) -> None:
    """Raise InputError where the arm is another one: by its name, and by where its tool is."""
    arm = chosen_arm(scenario.robot)
    try:
        with Dashboard(host) as dashboard:
            said = dashboard.ask("get robot model")
    except DashboardError as error:
        raise InputError(f"robot.host {host}: {error}") from None
    known = bool(scenario.robot.known_model)
    if known and said.upper().startswith("UR") and said.upper().rstrip("E") != arm.title.upper().rstrip("E"):
        raise InputError(f"robot.model: the scenario has a {arm.title}, the controller at {host} says {said}")
    tcp = facts.values.get("tcp_offset")
    if tcp is None:
        return
    away = _apart(arm, facts, tcp)
    if away > SAME_PLACE:
        raise InputError(
            f"robot.model: by the {arm.title}'s kinematics the tool is {away * 1e3:.0f} mm from where the controller "
            f"at {host} has it: it is another arm"
        )


def _apart(arm: ArmModel, facts: Facts, tcp: list[float]) -> float:
    ours = poses.tcp_pose(arm, np.array(facts.values["actual_q"]), tcp)
    return float(np.linalg.norm(np.array(ours[:3]) - np.array(facts.values["actual_TCP_pose"][:3])))


def _check_payload(settings: UrSettings, facts: Facts) -> None:
    """Raise InputError where somebody has told the controller of another payload than the scenario has."""
    has = facts.values.get("payload")
    wanted = settings.payload
    if has is None or wanted is None or has <= SAME_PAYLOAD or abs(has - wanted) <= SAME_PAYLOAD:
        return
    raise InputError(
        f"robot.ur.payload: the scenario has {wanted:g} kg, the controller {has:g} kg; set the one that is true"
    )
