"""Where: kinds of scenes, each drawn from a seed. A draw that does not hold what its kind promises gives None.

All promise that something is in the way: on the straight line from one target to the next, or crossing it. Scenes of
the sphere lie in the xz-plane: the paper's box as a point with its radius and lag, decided at 10 Hz, moved and measured
at 100 Hz. Scenes of arms stand on a table, at 500 Hz in PyBullet.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import msgspec
import numpy as np
from numpy.random import Generator

from farhand.common.geometry import Array, Vector3, distance, to_vector3
from farhand.common.shapes.distance import distance_to
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.plane import Plane
from farhand.common.shapes.sphere import Sphere
from farhand.laboratory.campaigns.tasks import BOX_RADIUS, OWN_EFFORT, box_settings, make_task
from farhand.operator_side.control.settings import ControllerSettings
from farhand.operator_side.margins.settings import MarginSettings
from farhand.runs.scenario import Scenario, load_scenario
from farhand.trials.safety.dead_ends import OUT_OF_PLANE, connected
from farhand.trials.safety.scenes import draw_scene, sampled

RATE_HZ = 100.0
TARGETS = 2
TRIES = 400
D_MIN = ControllerSettings().d_min
GAP = 2.0 * BOX_RADIUS + 2.0 * D_MIN + 0.02
"""Of a passage, from surface to surface (m)."""

Draw = Callable[[Generator], Scenario | None]


@dataclass(frozen=True)
class Scene:
    """Attributes:
    says: what it is, in one line.
    draw: a scenario, or None where the draw does not fit.
    robot: `sphere` or `arm`: an arm's run takes some five times as long.
    """

    says: str
    draw: Draw
    robot: str = "sphere"


def _static(rng: Generator) -> Scenario | None:
    task = make_task(int(rng.integers(2**31)), 0, effort=OWN_EFFORT)
    if not _blocked((task.start, *task.targets[:TARGETS]), task.obstacles, BOX_RADIUS):
        return None
    robot = msgspec.structs.replace(task.robot, rate_hz=RATE_HZ)
    return msgspec.structs.replace(task, name="static", targets=task.targets[:TARGETS], robot=robot)


def _clutter(rng: Generator) -> Scenario | None:
    low, high = 0.45, 4.5
    count = int(rng.integers(10, 21))
    obstacles: list[Obstacle] = []
    for _ in range(4000):
        radius, centre = float(rng.uniform(0.1, 0.35)), _in_plane(rng, low, high)
        if all(distance(centre, o.position) >= radius + o.shape.bounding_radius for o in obstacles):
            obstacles.append(_ball(len(obstacles), centre, radius))
            if len(obstacles) == count:
                break
    if len(obstacles) < count:
        return None
    points = _points(rng, obstacles, lambda: _in_plane(rng, low, high), clear=BOX_RADIUS + 0.06, leg=1.0)
    if points is None or not connected(points, obstacles):
        return None
    return _flight("clutter", points, obstacles, flat=True)


def _passage(rng: Generator) -> Scenario | None:
    """A wall of balls with one gap, a target behind it and one in front."""
    radii = rng.uniform(0.3, 0.6, 2)
    middle = np.array([2.5, 0.0, float(rng.uniform(1.5, 3.5))])
    obstacles: list[Obstacle] = []
    for sign, radius in zip((-1.0, 1.0), radii, strict=True):
        z = 0.5 * GAP + float(radius)
        for number in range(4):
            centre = middle + np.array([0.0, 0.0, sign * (z + 1.8 * number * float(radius))])
            obstacles.append(_ball(len(obstacles), to_vector3(centre.tolist()), float(radius)))
    turned_wall = float(rng.uniform(-0.5, 0.5))
    turn = np.array(
        [[math.cos(turned_wall), math.sin(turned_wall)], [-math.sin(turned_wall), math.cos(turned_wall)]]
    )
    obstacles = [
        msgspec.structs.replace(o, position=_turned(np.array(o.position), middle, turn)) for o in obstacles
    ]
    points = []
    for side in (-1.0, 1.0, -1.0):
        away = np.array([side * rng.uniform(1.2, 1.8), 0.0, rng.uniform(-0.4, 0.4)])
        points.append(_turned(middle + away, middle, turn))
    if any(distance_to(o, p) < BOX_RADIUS + 0.3 for o in obstacles for p in points):
        return None
    return _flight("passage", points, obstacles, flat=True)


def _movers(speed: float) -> Draw:
    def draw(rng: Generator) -> Scenario | None:
        low, high = 0.45, 4.0
        obstacles: list[Obstacle] = []
        for _ in range(3):
            obstacles.append(_ball(len(obstacles), _in_plane(rng, low, high), float(rng.uniform(0.2, 0.4))))
        for _ in range(3):
            path = (_in_plane(rng, low, high), _in_plane(rng, low, high))
            if distance(*path) < 1.5:
                return None
            obstacles.append(
                Obstacle(
                    id=f"mover-{len(obstacles)}",
                    shape=Sphere(float(rng.uniform(0.15, 0.3))),
                    path=path,
                    speed=speed,
                    acceleration=1.0,
                    phase=float(rng.uniform(0.0, 5.0)),
                )
            )
        swept = [place for o in obstacles for place in sampled(o, 0.1)]
        points = _points(rng, swept, lambda: _in_plane(rng, low, high), clear=BOX_RADIUS + 0.2, leg=1.5)
        return None if points is None else _flight(f"movers-{speed:g}", points, obstacles)

    return draw


def _shapes(rng: Generator) -> Scenario | None:
    low, high = 0.45, 3.6
    count = int(rng.integers(5, 10))

    def place(draw: Generator) -> Array:
        x, z = draw.uniform(low, high, 2)
        return np.array([x, draw.uniform(-0.2, 0.2), z])

    found = draw_scene(rng, count=count, place=place, size=(0.1, 0.4), speed=0.0, fits=lambda _: True)
    points = _points(rng, found, lambda: _in_plane(rng, low, high), clear=BOX_RADIUS + 0.25, leg=1.2)
    return None if points is None else _flight("shapes", points, found)


def _table(robot: str) -> Draw:
    """An arm over a table with two to five things on it."""
    template = load_scenario(f"{robot}-obstacle")
    radius = template.robot.radius

    def draw(rng: Generator) -> Scenario | None:
        def place(draw: Generator) -> Array:
            return draw.uniform([0.3, -0.45, 0.05], [0.75, 0.45, 0.35])

        def fits(obstacle: Obstacle) -> bool:
            return distance_to(obstacle, template.start) > radius + 0.1

        count = int(rng.integers(2, 6))
        found = draw_scene(rng, count=count, place=place, size=(0.03, 0.09), speed=0.0, fits=fits)
        top = Obstacle(id="table", shape=Plane(), position=(0.0, 0.0, -0.05))
        around = (*found, top)

        def point() -> Vector3:
            return to_vector3(rng.uniform([0.3, -0.45, 0.12], [0.65, 0.45, 0.5]).tolist())

        points = _points(rng, around, point, clear=radius + 0.04, leg=0.25, start=template.start)
        if points is None or not _blocked(points, found, radius):
            return None
        return msgspec.structs.replace(
            template,
            name=robot,
            description="an arm over a table",
            targets=tuple(points[1:]),
            obstacles=around,
        )

    return draw


SCENES: dict[str, Scene] = {
    "static": Scene("the paper's tasks: 6 to 12 balls at least 0.8 m apart", _static),
    "clutter": Scene("10 to 20 balls that may touch, in the plane", _clutter),
    "passage": Scene("through a wall: the robot, twice d_min and 20 mm", _passage),
    **{
        f"movers-{speed:g}": Scene(f"three balls stand, three shuttle at {speed:g} m/s", _movers(speed))
        for speed in (0.1, 0.3, 0.5)
    },
    "shapes": Scene("5 to 9 spheres, capsules, boxes and meshes", _shapes),
    "ur5": Scene("a UR5 over a table with 2 to 5 things on it", lambda rng: _table("ur5")(rng), "arm"),
    "panda": Scene("a Panda over a table with 2 to 5 things on it", lambda rng: _table("panda")(rng), "arm"),
}


def _flight(
    name: str, points: Sequence[Vector3], obstacles: Sequence[Obstacle], *, flat: bool = False
) -> Scenario:
    """The sphere's task from the first point through the others; `flat`: it may not leave the plane."""
    return Scenario(
        name=name,
        description=SCENES[name].says,
        start=points[0],
        targets=tuple(points[1:]),
        obstacles=tuple(obstacles),
        robot=msgspec.structs.replace(box_settings("point"), rate_hz=RATE_HZ),
        controller=ControllerSettings(speed_limit=(0.5, OUT_OF_PLANE if flat else 0.5, 0.5)),
        margin=MarginSettings(own={"paper": {"max_speed": 0.87}}),
    )


def _points(
    rng: Generator,
    obstacles: Sequence[Obstacle],
    point: Callable[[], Vector3],
    *,
    clear: float,
    leg: float,
    start: Vector3 | None = None,
) -> list[Vector3] | None:
    """Start and targets: `clear` of everything, a `leg` from one to the next (m)."""
    found = [] if start is None else [start]
    for _ in range(TRIES):
        here = point()
        if found and distance(found[-1], here) < leg:
            continue
        if all(distance_to(o, here) >= clear for o in obstacles):
            found.append(here)
            if len(found) > TARGETS:
                return found
    return None


def _blocked(points: Sequence[Vector3], obstacles: Sequence[Obstacle], radius: float) -> bool:
    """Whether a sphere that goes straight from point to point meets something, or the way of something."""
    places = [place for o in obstacles for place in sampled(o, 0.05)]
    for start, end in pairwise(points):
        for share in np.linspace(0.0, 1.0, 1 + round(distance(start, end) / 0.02)):
            here = to_vector3((np.array(start) + share * (np.array(end) - np.array(start))).tolist())
            if any(distance_to(o, here) < radius + D_MIN for o in places):
                return True
    return False


def _in_plane(rng: Generator, low: float, high: float) -> Vector3:
    x, z = rng.uniform(low, high, 2)
    return (float(x), 0.0, float(z))


def _ball(number: int, centre: Vector3, radius: float) -> Obstacle:
    return Obstacle(id=f"ball-{number}", position=centre, shape=Sphere(radius))


def _turned(point: Array, about: Array, turn: Array) -> Vector3:
    """A point turned in the xz-plane."""
    away = point - about
    x, z = turn @ away[[0, 2]]
    return to_vector3((about + np.array([x, away[1], z])).tolist())
