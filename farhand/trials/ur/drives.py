"""The task of the demo with the emulated arm: in real time by real programs, and beside the simulated arm.

Beside it in virtual time, where the network and the operator repeat: what two arms differ by is the arms' alone.
"""

import itertools
import json
import tempfile
from collections.abc import Sequence
from contextlib import closing
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from rich.table import Table

from farhand.common.geometry import Array, Twist
from farhand.common.link.ports import free_ports
from farhand.common.process.console import page, whole
from farhand.common.process.signals import say
from farhand.laboratory.simulation import simulate
from farhand.robot_side.robots.pybullet_arm import ArmRobot
from farhand.robot_side.robots.robot import Robot
from farhand.robot_side.robots.settings import RobotScenario
from farhand.robot_side.scene.surroundings import Surroundings
from farhand.runs.scenario import Scenario, load_scenario, replace_setting
from farhand.trials.ur.idle_loop import IdleLoop
from farhand.trials.ur.lockstep import LockstepUr
from farhand.trials.ur.rig import Rig

NETWORKS = ("5g-urban", "uniform:50,200", "bursty-loss-20")
SCENARIO = "ur5-obstacle"
SEEDS = (1, 2, 3)
"""Of what is driven in virtual time; what is driven in real time has the first."""
ALIKE = 0.002
"""m, that the two paths may be apart."""
MOST_OVERRUNS = 1e-3
CLEAR = 0.01
"""m, that the tool keeps."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """Attributes:
    network: between operator and robot.
    finished: whether all targets were reached.
    clearance: least, of the tool's sphere (m).
    arm_clearance: least, of the whole arm (m).
    apart, apart_driven, apart_late, apart_draws: how far paths are from each other: see `Apart` (m).
    overruns: share of the robot's periods that were missed.
    idle_overruns: the same of a loop beside it that does nothing: the machine's own.
    """

    network: str
    finished: bool
    clearance: float
    arm_clearance: float
    apart: float
    apart_driven: float
    apart_late: float
    apart_draws: float
    overruns: float
    idle_overruns: float

    @property
    def good(self) -> bool:
        """Whether it is as good as the simulated arm's."""
        safe = self.clearance >= CLEAR and self.arm_clearance >= CLEAR
        return self.finished and safe and self.apart <= ALIKE and self.overruns < MOST_OVERRUNS


def apart(path: Array, other: Array) -> float:
    """The farthest that a place of `path` (n, 3) is from the polyline `other` (m, 3), m."""
    starts, steps = other[:-1], np.diff(other, axis=0)
    lengths = np.maximum((steps * steps).sum(axis=1), 1e-18)
    farthest = 0.0
    for place in path:
        along = np.clip(((place - starts) * steps).sum(axis=1) / lengths, 0.0, 1.0)
        farthest = max(farthest, float(np.linalg.norm(starts + along[:, None] * steps - place, axis=1).min()))
    return farthest


def drive(rig: Rig, network: str, folder: Path, rate_hz: float) -> tuple[bool, dict[str, Any], float]:
    """Operator, network and robot until the task is over.

    Returns whether it was finished, the robot's result, and the share of periods that an idle loop beside it missed.
    """
    operator_port, robot_port = free_ports(2)
    near, far = (f"tcp/127.0.0.1:{port}" for port in (operator_port, robot_port))
    words = ("--network", network, "--seed", str(SEEDS[0]), "--listen-operator", near, "--listen-robot", far)
    rig.start_beside("netem", "netem", *words)
    result = folder / "robot.json"
    rig.endpoint = far
    rig.start_robot(connects=True, result=result)
    idle = IdleLoop(rate_hz)
    words = ("--robot", "ur", "--connect", near, "--time-limit", "120", "--scenario", SCENARIO)
    try:
        code = rig.farhand("operator", *words)
    finally:
        missed = idle.end()
    rig.interrupt("robot")
    rig.interrupt("netem")
    found: dict[str, Any] = json.loads(result.read_text())
    return code == 0, found, missed


class Apart(NamedTuple):
    """How far the paths of two tools are apart, in virtual time, over the same network (m).

    Attributes:
        alike: of the emulated and the simulated arm, both asked for the very same twists.
        driven: of the same two, each driven by an operator of its own: where a target counts as reached a tick
            earlier, the operator turns earlier.
        late: of two simulated arms, each driven so, of which one answers one period later: what instants alone do.
        draws: of the simulated arm over two draws of the network.
    """

    alike: float
    driven: float
    late: float
    draws: float


def apart_in_lockstep(network: str, rate_hz: float, seeds: Sequence[int] = SEEDS) -> Apart:
    """The largest over some draws of the network, and between them."""
    scenario = replace_setting(load_scenario(SCENARIO), "robot.rate_hz", rate_hz)
    found, paths = [], []
    for seed in seeds:

        def path(robot: Robot, seed: int = seed) -> Array:
            return places(simulate(scenario, network=network, seed=seed, robot=robot).trajectory)

        with closing(ArmRobot(scenario)) as arm, closing(LateArm(scenario)) as later:
            simulated, late = path(arm), path(later)
        with closing(LockstepUr(scenario)) as emulator:
            emulated = path(emulator)
        followed = _followed(scenario, emulator, 1.0 / rate_hz)
        pairs = (followed, emulated), (simulated, emulated), (simulated, late)
        found.append([both_ways(*pair) for pair in pairs])
        paths.append(simulated)
    draws = [both_ways(*pair) for pair in itertools.combinations(paths, 2)]
    alike, driven, late = (max(each) for each in zip(*found, strict=True))
    return Apart(alike, driven, late, max(draws, default=0.0))


class LateArm(ArmRobot):
    """The simulated arm, in which all takes effect one period later."""

    def __init__(self, scenario: RobotScenario) -> None:
        super().__init__(scenario)
        self._before: tuple[Twist, Surroundings | None] | None = None

    def step(self, twist: Twist, dt: float, surroundings: Surroundings | None = None) -> None:
        """See Robot."""
        asked, self._before = self._before, (twist, surroundings)
        if asked is None:
            super().halt(dt)
        else:
            super().step(asked[0], dt, asked[1])


def both_ways(path: Array, other: Array) -> float:
    """`apart`, whichever of the two goes farther (m)."""
    return max(apart(path, other), apart(other, path))


def places(trajectory: Sequence[Sequence[float]]) -> Array:
    """(n, 3) places of the tool (m) in a trajectory."""
    return np.array(trajectory)[:, 1:4]


def _followed(scenario: Scenario, arm: LockstepUr, dt: float) -> Array:
    """(n, 3) places of the simulated tool under what the other arm was asked for (m)."""
    robot = ArmRobot(scenario)
    try:
        found = [robot.sample().position]
        for asked in arm.asked:
            if asked is None:
                robot.halt(dt)
            else:
                robot.step(asked[0], dt, asked[1])
            found.append(robot.sample().position)
    finally:
        robot.close()
    return np.array(found[:: round(0.02 / dt)])


def run_drives(address: str, rate_hz: float, networks: tuple[str, ...], as_json: bool) -> int:
    """Drive over each of the networks; returns 0 where all are good, else 1."""
    drives: list[Drive] = []
    for network in networks or NETWORKS:
        say("trial", network)
        with tempfile.TemporaryDirectory(prefix="farhand-ur-") as folder:
            rig = Rig(Path(folder), address, rate_hz, driven=False)
            try:
                finished, result, missed = drive(rig, network, Path(folder), rate_hz)
            finally:
                rig.close()
        found = apart_in_lockstep(network, rate_hz)
        drives.append(
            Drive(
                network=network,
                finished=finished,
                clearance=result["min_clearance"],
                arm_clearance=result["min_arm_clearance"],
                apart=found.alike,
                apart_driven=found.driven,
                apart_late=found.late,
                apart_draws=found.draws,
                overruns=result["overruns"] / max(1, result["ticks"]),
                idle_overruns=missed,
            )
        )
        say("trial", f"  {'good' if drives[-1].good else 'NOT GOOD'}")
    _show(drives, rate_hz, as_json)
    return 0 if all(each.good for each in drives) else 1


def _show(drives: list[Drive], rate_hz: float, as_json: bool) -> None:
    if as_json:
        print(json.dumps([asdict(each) for each in drives]))
        return
    table = Table(title=f"{SCENARIO}, the emulated arm at {rate_hz:g} Hz", title_justify="left")
    for column in (
        "network",
        "finished",
        "tool clear (mm)",
        "arm clear (mm)",
        "apart (mm)",
        "apart driven (mm)",
        "apart late (mm)",
        "two draws (mm)",
        "overruns",
        "idle loop's",
    ):
        table.add_column(column)
    for each in drives:
        clear = f"{each.clearance * 1e3:.1f}", f"{each.arm_clearance * 1e3:.1f}", f"{each.apart * 1e3:.2f}"
        apart_by = each.apart_driven, each.apart_late, each.apart_draws
        others = [f"{metres * 1e3:.2f}" for metres in apart_by]
        missed = f"{each.overruns:.3%}", f"{each.idle_overruns:.3%}"
        table.add_row(each.network, "yes" if each.finished else "NO", *clear, *others, *missed)
    console = page()
    console.print(whole(table, console))
