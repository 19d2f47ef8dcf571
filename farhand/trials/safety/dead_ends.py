"""Dense fields, in which a tester that drives straight on gets stuck: what do side-steps change?

    python -m farhand.trials.safety.dead_ends --tasks 40

Each task is a point robot among 10 to 20 circles in the xz-plane that may touch each other; a way from target to target
exists in every one. The robot may not leave the plane, which would be a way round any sphere; the guard is off, so that
the operator's side alone is measured. Prints one line without and one with `steering.tester.sidestep`; exit code 1 if
any task came below d_min.
"""

import argparse
import sys
from collections.abc import Sequence

import msgspec
import numpy as np

from farhand.common.geometry import Vector3, distance
from farhand.common.messages.scene import Obstacle
from farhand.common.seeds import stream
from farhand.laboratory.campaigns.jobs import Job, Row
from farhand.laboratory.campaigns.tasks import BOX_RADIUS, box_settings
from farhand.operator_side.control.settings import ControllerSettings
from farhand.runs.run import Run
from farhand.runs.scenario import Scenario, replace_settings
from farhand.trials.safety.rows import rows_of

LOW, HIGH = 0.45, 4.5
COUNT = (10, 20)
RADII = (0.1, 0.35)
TARGETS = 3
TRIES = 4000
TIME_LIMIT = 180.0
CLEAR = 0.06
"""Beyond the robot's radius, at the start and at targets (m)."""
WAY = 0.05
"""The same all along the way that must exist (m): d_min and the least margin."""
OUT_OF_PLANE = 0.001
"""m/s."""
_CELLS, _ROOM = 160, 1.2


def dense_task(seed: int, index: int) -> Scenario:
    """Task `index`: a field, a start and three targets, connected in the plane."""
    draw = stream(seed, "dense", str(index))
    count = int(draw.integers(COUNT[0], COUNT[1] + 1))
    while True:
        obstacles = _obstacles(draw, count)
        if len(obstacles) < count:
            continue
        points = _points(draw, obstacles)
        if len(points) > TARGETS and connected(points, obstacles):
            break
    scenario = Scenario(
        name=f"dense-{seed}-{index}",
        description="a dense field in the xz-plane",
        start=points[0],
        targets=tuple(points[1:]),
        obstacles=tuple(obstacles),
        robot=box_settings("point"),
        controller=ControllerSettings(speed_limit=(0.5, OUT_OF_PLANE, 0.5)),
    )
    return replace_settings(scenario, {"guard.on": False})


def connected(points: Sequence[Vector3], obstacles: Sequence[Obstacle]) -> bool:
    """Whether the robot fits through from each point to each other, in the plane, on a grid of 4 cm."""
    low, high = LOW - _ROOM, HIGH + _ROOM
    grid = np.linspace(low, high, _CELLS)
    free = np.ones((_CELLS, _CELLS), dtype=bool)
    for o in obstacles:
        away = np.hypot(grid[:, None] - o.position[0], grid[None, :] - o.position[2])
        free &= away >= o.shape.bounding_radius + BOX_RADIUS + WAY
    cells = [tuple(round((p[k] - low) / (high - low) * (_CELLS - 1)) for k in (0, 2)) for p in points]
    reached = np.zeros_like(free)
    reached[cells[0]] = free[cells[0]]
    while True:
        grown = reached.copy()
        grown[1:] |= reached[:-1]
        grown[:-1] |= reached[1:]
        grown[:, 1:] |= reached[:, :-1]
        grown[:, :-1] |= reached[:, 1:]
        grown &= free
        if (grown == reached).all():
            return all(bool(reached[cell]) for cell in cells)
        reached = grown


def jobs_for(seed: int, tasks: int, network: str, *, sidestep: bool) -> list[Job]:
    """One job a task."""
    found = []
    for index in range(tasks):
        scenario = replace_settings(dense_task(seed, index), {"steering.tester": {"sidestep": sidestep}})
        run = msgspec.structs.replace(Run.over(scenario, network, seed=index), time_limit=TIME_LIMIT)
        found.append(Job(key=f"{sidestep}/{index}", labels={"task": index}, run=run))
    return found


def main(words: Sequence[str] | None = None) -> int:
    """Run, print, return the exit code."""
    options = _parser().parse_args(words)
    low = 0
    for sidestep in (False, True):
        rows = rows_of(
            jobs_for(options.seed, options.tasks, options.network, sidestep=sidestep), options.workers
        )
        low += _tell("with side-steps" if sidestep else "straight on", rows)
    return 1 if low else 0


def _obstacles(draw: np.random.Generator, count: int) -> list[Obstacle]:
    found: list[Obstacle] = []
    for _ in range(TRIES):
        radius = float(draw.uniform(*RADII))
        centre = _point(draw)
        if all(distance(centre, o.position) >= radius + o.shape.bounding_radius for o in found):
            found.append(Obstacle(id=f"o{len(found)}", position=centre, radius=radius))
            if len(found) == count:
                break
    return found


def _points(draw: np.random.Generator, obstacles: Sequence[Obstacle]) -> list[Vector3]:
    found: list[Vector3] = []
    for _ in range(TRIES):
        point = _point(draw)
        clear = all(
            distance(point, o.position) >= o.shape.bounding_radius + BOX_RADIUS + CLEAR for o in obstacles
        )
        if clear and all(distance(point, other) >= 1.0 for other in found):
            found.append(point)
            if len(found) > TARGETS:
                break
    return found


def _point(draw: np.random.Generator) -> Vector3:
    x, z = draw.uniform(LOW, HIGH, 2)
    return (float(x), 0.0, float(z))


def _tell(what: str, rows: list[Row]) -> int:
    """One line; returns how many tasks came below d_min or crashed."""
    low = sum(bool(row.error) or not row.safe for row in rows)
    nearest = min((row.min_clearance for row in rows if row.min_clearance is not None), default=float("nan"))
    finished = [row.duration or 0.0 for row in rows if row.finished]
    mean = sum(finished) / len(finished) if finished else float("nan")
    print(
        f"{what}: {len(finished)} of {len(rows)} finished ({mean:.1f} s in the mean), "
        f"{low} below d_min, least {1e3 * nearest:.1f} mm",
        flush=True,
    )
    return low


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m farhand.trials.safety.dead_ends",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--tasks", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1, help="of the tasks")
    parser.add_argument("--network", default="none", help="SPEC, each way")
    parser.add_argument("--workers", type=int, default=1, help="processes; 0: this one alone")
    return parser


if __name__ == "__main__":
    sys.exit(main())
