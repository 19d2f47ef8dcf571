"""One wiring for both worlds: the three nodes are made here for the programs and for virtual time alike."""

import importlib.metadata
import platform
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path

from farhand.common.link.link import Link
from farhand.common.seeds import stream
from farhand.netem.emulation import Emulation
from farhand.netem.netem_node import MessageLog, NetemNode
from farhand.netem.timeline import load_timeline
from farhand.operator_side.control.controller import Controller
from farhand.operator_side.operator_node import OperatorIdentity, OperatorNode
from farhand.operator_side.steering.device import SteeringDevice
from farhand.operator_side.steering.registry import make_device
from farhand.robot_side.robot_node import RobotNode
from farhand.robot_side.robots.registry import make_robot
from farhand.robot_side.robots.robot import Robot
from farhand.runs.run import Run
from farhand.runs.scenario import Scenario

OPERATOR_NAME = "operator"
"""The operator's name in virtual time and in the demo, whoever runs them."""


def session_of(seed: int, side: str) -> int:
    """A session for virtual time; programs draw theirs from the operating system."""
    return int(stream(seed, "session", side).integers(1, 1 << 62))


def make_operator(
    scenario: Scenario,
    link: Link,
    who: OperatorIdentity,
    controller: Controller,
    stopwatch: Callable[[], float] | None = None,
    device: SteeringDevice | None = None,
) -> OperatorNode:
    """The operator's node with the scenario's device or another one; `controller` is prepared already."""
    device = make_device(scenario.steering) if device is None else device
    return OperatorNode(scenario, controller, device, link, who, stopwatch)


def make_netem(operator_link: Link, robot_link: Link, run: Run, logs: Sequence[MessageLog] = ()) -> NetemNode:
    """The run's emulated network between two links; each of the logs takes the fate of every message."""
    schedule = load_timeline(run.timeline) if run.timeline else None
    emulation = Emulation(run.network.uplink.spec, run.network.downlink.spec, run.seed)
    return NetemNode(operator_link, robot_link, emulation, schedule=schedule, logs=logs)


def make_robot_node(
    scenario: Scenario, link: Link, name: str, session: int, robot: Robot | None = None
) -> RobotNode:
    """The robot's node with the scenario's robot, or with another one."""
    return RobotNode(scenario, make_robot(scenario) if robot is None else robot, link, name, session)


def source_state() -> str:
    """The commit that runs, as `git describe` says, with a mark where files differ from it; empty: not from a clone."""
    here = Path(__file__).resolve()
    if not _git(
        here.parent, "ls-files", "--error-unmatch", here.name
    ):  # in somebody else's repository, or none
        return ""
    return _git(here.parent, "describe", "--always", "--dirty", "--abbrev=12")


def _git(folder: Path, *words: str) -> str:
    """What a git command says; empty where it fails."""
    try:
        found = subprocess.run(
            ["git", "-C", str(folder), *words], capture_output=True, text=True, timeout=5.0, check=False
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return found.stdout.strip() if found.returncode == 0 else ""


def versions() -> dict[str, str]:
    """Versions of what decides results."""
    names = ("farhand", "numpy", "numba", "casadi", "daqp", "pybullet", "pin", "eclipse-zenoh", "msgspec")
    found = {"python": platform.python_version()}
    for name in names:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            found[name] = "absent"
    return found
