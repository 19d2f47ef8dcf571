"""A UR5 among clutter: does it still get its work done with the guard on?

    python -m farhand.trials.safety.clutter --tasks 20

Each task is a UR5, tool down, among 5 to 9 obstacles of mixed shapes, with two targets. It is posed only where the arm
can get from the start to each target: on a grid of 5 cm, from configuration to configuration, all links and the tool's
sphere clear. Prints one line with the tester driving straight on and one with side-steps; exit code 1 if any run
was not safe.
"""

import argparse
import sys
from collections import deque
from collections.abc import Sequence

import msgspec
import numpy as np
from numpy.random import Generator

from farhand.common.geometry import Array, Vector3, to_vector3
from farhand.common.messages.scene import Obstacle
from farhand.common.seeds import stream
from farhand.laboratory.campaigns.jobs import Job, Row
from farhand.robot_side.arm.kinematics import Kinematics
from farhand.robot_side.arm.model import model
from farhand.robot_side.kernel.distance import capsule_row
from farhand.robot_side.safety.guard.arm_guard import body_of, placed
from farhand.robot_side.scene.surroundings import Surroundings, surroundings_of
from farhand.runs.run import Run
from farhand.runs.scenario import Scenario, load_scenario, replace_settings
from farhand.trials.safety.rows import rows_of
from farhand.trials.safety.scenes import draw_scene

CELL = 0.05
"""Of the grid (m)."""
LOW, HIGH = np.array([-0.1, -0.65, 0.1]), np.array([0.7, 0.65, 0.6])
"""The room in which the work lies (m)."""
NEAR, FAR = 0.3, 0.7
"""From the column (m)."""
ARM_CLEAR = 0.03
TOOL_CLEAR = 0.03
"""Beyond the tool's sphere (m)."""
JUMP = 0.6
"""Between the configurations of neighbouring cells no joint turns further (rad)."""
TARGETS = 2
TIME_LIMIT = 120.0
_TRIES = 200
Cell = tuple[int, int, int]


class Reach:
    """Which cells the arm gets to from its start among some obstacles, tool down.

    Args:
        arm: kinematics and body of the arm.
        obstacles: what is in the way.
        radius: of the tool's sphere (m).
    """

    def __init__(self, arm: "Arm", obstacles: Sequence[Obstacle], radius: float) -> None:
        self._arm, self._around, self._radius = arm, surroundings_of(obstacles), radius
        self.found: dict[Cell, Array] = {}

    def spread(self, start: Vector3, q: Array) -> None:
        """Fill `found` with the cells that are reached from a start (m) at joint positions q (rad)."""
        first = cell_of(start)
        self.found = {first: q}
        waiting = deque([first])
        while waiting:
            cell = waiting.popleft()
            for neighbour in _neighbours(cell):
                if neighbour not in self.found:
                    there = self._goes(neighbour, self.found[cell])
                    if there is not None:
                        self.found[neighbour] = there
                        waiting.append(neighbour)

    def is_clear(self, position: Vector3, q: Array) -> bool:
        """Whether links and tool keep their distances."""
        point = np.array(position)
        if _gap(point, point, self._radius, self._around) < TOOL_CLEAR:
            return False
        return all(
            _gap(a, b, radius, self._around) >= ARM_CLEAR for a, b, radius in self._arm.moving_capsules(q)
        )

    def _goes(self, cell: Cell, seed: Array) -> Array | None:
        position = centre_of(cell)
        if not NEAR <= np.hypot(position[0], position[1]) <= FAR:
            return None
        q = self._arm.kinematics.inverse(position, self._arm.kinematics.R_base_tool_down, seed)
        if q is None or np.abs(q - seed).max() > JUMP or not self.is_clear(position, q):
            return None
        return q


class Arm:
    """A UR5 that is nowhere in particular."""

    def __init__(self) -> None:
        self._model = model("ur5")
        self._body = body_of(self._model, 0.0)
        self.kinematics = Kinematics(self._model)

    def moving_capsules(self, q: Array) -> list[tuple[Array, Array, float]]:
        """Ends and radius of each capsule but the base's, at joint positions q (6,), rad."""
        A, B = placed(self._body, q)
        rows = list(zip(A, B, self._body.capsules, strict=True))
        return [(a, b, float(row[7])) for a, b, row in rows[: self._body.whole] if row[0] >= 0]


def cluttered_task(seed: int, index: int) -> Scenario:
    """Task `index`: clutter, a start and two targets that the arm gets to from there."""
    rng = stream(seed, "clutter", str(index))
    template, arm = load_scenario("ur5-obstacle"), Arm()
    home = np.array(template.robot.joints)
    while True:
        count = int(rng.integers(5, 10))
        obstacles = _clutter(rng, count, arm, template, home)
        reach = Reach(arm, obstacles, template.robot.radius)
        reach.spread(template.start, home)
        start = np.array(template.start)
        far = [c for c in reach.found if np.linalg.norm(np.array(centre_of(c)) - start) > 0.35]
        if len(obstacles) == count and len(far) > 20:
            targets = tuple(centre_of(far[int(k)]) for k in rng.integers(0, len(far), TARGETS))
            if len(set(targets)) == TARGETS:
                break
    return msgspec.structs.replace(
        template,
        name=f"clutter-{seed}-{index}",
        description="a UR5 among clutter",
        targets=targets,
        obstacles=tuple(obstacles),
    )


def cell_of(point: Vector3) -> Cell:
    """The cell that holds a point (m)."""
    x, y, z = np.floor((np.array(point) - LOW) / CELL).astype(int).tolist()
    return (x, y, z)


def centre_of(cell: Cell) -> Vector3:
    """Its middle (m)."""
    return to_vector3((LOW + (np.array(cell) + 0.5) * CELL).tolist())


def jobs_for(seed: int, tasks: int, network: str, *, sidestep: bool, guard: bool = True) -> list[Job]:
    """One job a task."""
    found = []
    for index in range(tasks):
        settings = {"steering.tester": {"sidestep": sidestep}, "guard.on": guard}
        scenario = replace_settings(cluttered_task(seed, index), settings)
        run = msgspec.structs.replace(Run.over(scenario, network, seed=index), time_limit=TIME_LIMIT)
        found.append(Job(key=f"{sidestep}/{guard}/{index}", labels={"task": index}, run=run))
    return found


def main(words: Sequence[str] | None = None) -> int:
    """Run, print, return the exit code."""
    options = _parser().parse_args(words)
    unsafe = 0
    for name, sidestep, guard in (
        ("guard off", False, False),
        ("straight on", False, True),
        ("with side-steps", True, True),
    ):
        jobs = jobs_for(options.seed, options.tasks, options.network, sidestep=sidestep, guard=guard)
        low = _tell(name, rows_of(jobs, options.workers))
        unsafe += low if guard else 0
    return 1 if unsafe else 0


def _neighbours(cell: Cell) -> list[Cell]:
    x, y, z = cell
    sides = [(x - 1, y, z), (x + 1, y, z), (x, y - 1, z), (x, y + 1, z), (x, y, z - 1), (x, y, z + 1)]
    most = np.floor((HIGH - LOW) / CELL).astype(int).tolist()
    return [side for side in sides if all(0 <= k < n for k, n in zip(side, most, strict=True))]


def _gap(a: Array, b: Array, radius: float, around: Surroundings) -> float:
    return min(float(capsule_row(a, b, radius, row, around.vertices)[0]) for row in around.rows)


def _clutter(rng: Generator, count: int, arm: Arm, template: Scenario, home: Array) -> list[Obstacle]:
    def place(draw: Generator) -> Array:
        while True:
            point = draw.uniform(LOW, HIGH)
            if NEAR <= float(np.hypot(point[0], point[1])) <= FAR:
                return np.asarray(point)

    def fits(obstacle: Obstacle) -> bool:
        return Reach(arm, [obstacle], template.robot.radius).is_clear(template.start, home)

    return list(draw_scene(rng, count=count, place=place, size=(0.03, 0.08), speed=0.0, fits=fits))


def _tell(name: str, rows: list[Row]) -> int:
    done = [row for row in rows if row.finished]
    unsafe = sum(bool(row.error) or not row.safe for row in rows)
    seconds = float(np.mean([row.duration or 0.0 for row in done])) if done else float("nan")
    print(
        f"{name}: {len(done)} of {len(rows)} finished, {seconds:.1f} s on average, {unsafe} not safe",
        flush=True,
    )
    return unsafe


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1, help="of the tasks")
    parser.add_argument("--network", default="none", help="SPEC, each way")
    parser.add_argument("--workers", type=int, default=1, help="processes; 0: this one alone")
    return parser


if __name__ == "__main__":
    sys.exit(main())
