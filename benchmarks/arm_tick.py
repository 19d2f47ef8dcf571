"""What one period of an arm costs, part by part, and how many times real time that is.

`python -m benchmarks.arm_tick [--quick] [--json FILE]`. The parts are timed in turn within every period of one drive,
so that they meet the same machine; compare them with one another, and nothing across runs. "Tick" is everything that
the robot's program does in a period with guard and 20 obstacles, states sent at 100 Hz included, besides the physics.
"""

import argparse
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from benchmarks.robot_loop import driven
from farhand.common.geometry import Twist
from farhand.common.messages.scene import Obstacle
from farhand.common.seeds import stream
from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.sphere import Sphere
from farhand.common.timing.clock import thread_seconds
from farhand.robot_side.robots.pybullet_arm import ArmRobot
from farhand.robot_side.safety.guard.arm_guard import ArmGuard, Joints
from farhand.robot_side.scene.surroundings import surroundings_of
from farhand.runs.scenario import Scenario, load_scenario, replace_setting

DT = 0.002
PERIODS, QUICK = 4000, 60
OBSTACLES = 20
WISHED = {"ur5": 150e-6, "panda": 200e-6}
"""s: p99 of all but the physics, with the guard and 20 obstacles."""


def clutter(robot: ArmRobot) -> tuple[Obstacle, ...]:
    """Spheres, capsules and boxes all around the arm, none in it."""
    rng = stream(1, "clutter")
    shapes = (Sphere(0.06), Capsule(0.03, 0.1), Box((0.04, 0.05, 0.06)))
    found: list[Obstacle] = []
    while len(found) < OBSTACLES:
        angle, radius = rng.uniform(-np.pi, np.pi), rng.uniform(0.3, 0.9)
        position = (
            float(radius * np.cos(angle)),
            float(radius * np.sin(angle)),
            float(rng.uniform(0.0, 0.9)),
        )
        one = Obstacle(id=f"o{len(found)}", shape=shapes[len(found) % 3], position=position)
        gap = robot.arm_clearance((one,))
        if gap is None or gap > 0.1:
            found.append(one)
    return tuple(found)


class TimedPhysics:
    """PyBullet, with a stopwatch at its step.

    Attributes:
        spent: in `stepSimulation`, so far (s).
    """

    def __init__(self, bullet: Any) -> None:
        self._bullet = bullet
        self.spent = 0.0

    def __getattr__(self, name: str) -> Any:
        found = getattr(self._bullet, name)
        setattr(self, name, found)
        return found

    def stepSimulation(self, client: int) -> None:  # noqa: N802 (PyBullet's name)
        began = thread_seconds()
        self._bullet.stepSimulation(client)
        self.spent += thread_seconds() - began


def timed(do: Callable[[], object], into: list[float]) -> None:
    began = thread_seconds()
    do()
    into.append(thread_seconds() - began)


def parts(scenario: Scenario, periods: int) -> tuple[dict[str, list[float]], tuple[Obstacle, ...]]:
    """Seconds of each part in every period, and what stood around the arm meanwhile."""
    robot = ArmRobot(scenario)
    obstacles = clutter(robot)
    nothing, around = surroundings_of(()), surroundings_of(obstacles)
    guard = ArmGuard(robot.arm, scenario.guard, scenario.robot.lag, DT)
    control, still = robot.control, np.zeros(3)
    spent: dict[str, list[float]] = {name: [] for name in ("law", "guard", "guard 20", "period", "read")}
    for period in range(periods):
        v = np.array([0.0, 0.1, 0.0] if period // 500 % 2 == 0 else [0.0, -0.1, 0.0])
        q, qd, before = robot._q.copy(), robot._follower.qd.copy(), robot._follower.commanded.copy()
        joints, wanted = Joints(q, qd, before), control.R_base_wanted.copy()
        timed(lambda: control.joint_velocity(q, before, robot._follower._tool, v, DT, still), spent["law"])  # noqa: B023
        for name, scene in (("guard", nothing), ("guard 20", around)):
            timed(lambda: guard.command(joints, v, still, wanted, scene), spent[name])  # noqa: B023
        timed(robot.sample, spent["read"])
        timed(lambda: robot.step(Twist((v[0], v[1], v[2])), DT), spent["period"])  # noqa: B023
    robot.close()
    return spent, obstacles


def ticks(scenario: Scenario, periods: int) -> tuple[list[float], list[float]]:
    """Seconds of every tick of the robot's program, besides the physics, and of the physics."""
    robot = ArmRobot(scenario)
    physics = TimedPhysics(robot._bullet)
    robot._bullet = physics
    spent: list[float] = []
    of_physics: list[float] = []
    for step in driven(scenario, robot, periods * DT):
        before = physics.spent
        timed(step, spent)
        of_physics.append(physics.spent - before)
        spent[-1] -= of_physics[-1]
    robot.close()
    return spent, of_physics


def measure(model: str, periods: int) -> dict[str, Any]:
    """Seconds a period, of each part: median and p99."""
    scenario = msgspec.structs.replace(load_scenario(f"{model}-obstacle"), obstacles=())
    scenario = replace_setting(scenario, "robot.rate_hz", 1.0 / DT)
    spent, obstacles = parts(scenario, periods)
    cluttered = msgspec.structs.replace(scenario, obstacles=obstacles)
    spent["tick"], spent["physics"] = ticks(cluttered, periods)
    result: dict[str, Any] = {
        name: {"median": float(np.median(each)), "p99": float(np.quantile(each, 0.99))}
        for name, each in spent.items()
    }
    plain, beside = result["period"]["median"], result["law"]["median"]
    result["times real time, law"] = DT / plain
    result["times real time, guard 20"] = DT / (plain - beside + result["guard 20"]["median"])
    result["guard 20 to law"] = result["guard 20"]["median"] / beside
    result["wished"] = WISHED[model]
    return result


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the results here as well")
    parser.add_argument("--quick", action="store_true", help="to see that it works; the figures mean nothing")
    arguments = parser.parse_args()
    results = {model: measure(model, QUICK if arguments.quick else PERIODS) for model in WISHED}
    for model, found in results.items():
        print(model)
        for name, value in found.items():
            if isinstance(value, dict):
                wanted = f"   wanted: {found['wished'] * 1e6:.0f}" if name == "tick" else ""
                print(
                    f"  {name:10s} median {value['median'] * 1e6:6.1f} us, p99 {value['p99'] * 1e6:6.1f} us{wanted}"
                )
        print(f"  a period of physics and law: {found['times real time, law']:.0f} x real time")
        print(
            f"  with the guard and {OBSTACLES} obstacles: {found['times real time, guard 20']:.0f} x real time"
        )
        print(f"  guard to law {found['guard 20 to law']:.1f}")
    if arguments.json is not None:
        arguments.json.write_text(json.dumps(results, indent=2), encoding="utf-8")


if __name__ == "__main__":
    main()
