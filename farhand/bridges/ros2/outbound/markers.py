"""What RViz draws: obstacles and what is kept around them, targets, the robot to come, its plan, and what binds.

Every marker ends by itself two seconds after it was told last: what nobody confirms is not shown.
"""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from farhand.bridges.ros2.cdr.marker_array import Color, Marker
from farhand.common.messages.base import Vector3
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Scene
from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.mesh import Mesh
from farhand.common.shapes.obstacle import Obstacle, moved
from farhand.common.shapes.pose import out_of, rotation
from farhand.common.shapes.shape import Shape
from farhand.common.shapes.sphere import Sphere
from farhand.exports.ros_messages import PLANE_SIZE, PLANE_THICKNESS
from farhand.foxglove.figures import UPRIGHT

LIFETIME = 2
"""s; what stands is told again every second."""
TARGET_SIZE = 0.024
ORIGIN: Vector3 = (0.0, 0.0, 0.0)
CUBE, SPHERE, CYLINDER, LINES, BALLS, TEXT, TRIANGLES = 1, 2, 3, 4, 7, 9, 11
OBSTACLE: Color = (0.85, 0.45, 0.2, 0.9)
MARGIN: Color = (0.95, 0.75, 0.2, 0.22)
TARGET: Color = (0.2, 0.65, 0.35, 0.9)
GHOST: Color = (0.3, 0.55, 0.95, 0.35)
PLAN: Color = (0.3, 0.55, 0.95, 0.9)
BINDS: Color = (0.95, 0.6, 0.1, 1.0)


class Part(NamedTuple):
    """One marker of a shape.

    Attributes:
        kind: of marker.
        offset: of its centre in the shape's frame (m).
        scale: its size (m).
        points: its corners or balls in the shape's frame (m).
    """

    kind: int
    offset: Vector3
    scale: Vector3
    points: tuple[Vector3, ...] = ()


def parts_of(shape: Shape, grown: float = 0.0) -> list[Part]:
    """What draws a shape, grown all around (m); of a mesh that is grown the balls around its corners."""
    here: Vector3 = (0.0, 0.0, 0.0)
    if isinstance(shape, Sphere):
        return [Part(SPHERE, here, _cube(2.0 * (shape.radius + grown)))]
    if isinstance(shape, Capsule):
        wide = 2.0 * (shape.radius + grown)
        ends = (-shape.half_length, shape.half_length)
        tube = Part(CYLINDER, here, (wide, wide, 2.0 * shape.half_length))
        return [tube, *(Part(SPHERE, (0.0, 0.0, end), _cube(wide)) for end in ends)]
    if isinstance(shape, Box):
        x, y, z = shape.half_extents
        return [Part(CUBE, here, (2.0 * (x + grown), 2.0 * (y + grown), 2.0 * (z + grown)))]
    if isinstance(shape, Mesh):
        if grown:
            return [Part(BALLS, here, _cube(2.0 * grown), tuple(map(_point, shape.points)))]
        corners = shape.hull.corners.reshape(-1, 3)
        return [Part(TRIANGLES, here, _cube(1.0), tuple(map(_point, corners)))]
    return [Part(CUBE, (0.0, 0.0, grown - PLANE_THICKNESS / 2.0), (PLANE_SIZE, PLANE_SIZE, PLANE_THICKNESS))]


class Markers:
    """Attributes:
    d_min: distance to keep (m), for the shells around obstacles, to which the reports' margin is added; None: it
        is not known, and no shell is shown.
    """

    def __init__(self) -> None:
        self.d_min: float | None = None
        self._names: set[str] = set()

    def standing(self, scene: Scene, grown: float | None, age: float) -> list[Marker]:
        """Obstacles, shells and targets, and the ends of those that are no more.

        Args:
            scene: the newest.
            grown: what the margin adds (m); None: not known, and no shell is shown.
            age: of the scene (s).
        """
        markers = list(self._drawn([moved(each, age) for each in scene.obstacles], grown))
        here = Part(SPHERE, ORIGIN, _cube(TARGET_SIZE))
        markers += [_marker("targets", n, target, here, TARGET) for n, target in enumerate(scene.targets)]
        names = {each.id for each in scene.obstacles}
        for gone in sorted(self._names - names):
            for group in (f"obstacle {gone}", f"margin {gone}"):
                markers += [_end(group, number) for number in range(3)]
        self._names = names
        return markers

    def moving(self, scene: Scene | None, report: ControlReport, command: VelocityCommand | None, radius: float,
               age: float) -> list[Marker]:  # fmt: skip
        """What changes with every tick: movers, the ghost, the plan, what binds.

        Args:
            scene: the newest; None: none yet.
            report: of the tick.
            command: the newest; None: none yet.
            radius: of the robot's sphere (m).
            age: of the scene (s).
        """
        movers = [moved(each, age) for each in scene.obstacles if each.moves] if scene is not None else []
        markers = list(self._drawn(movers, report.inflation))
        if report.states:
            ball = Part(SPHERE, ORIGIN, _cube(2.0 * max(radius, 1e-3)))
            markers.append(_marker("ghost", 0, report.predicted, ball, GHOST))
            points = planned(report, command)
            line = Part(LINES, ORIGIN, (0.008, 0.0, 0.0), points)
            markers.append(_marker("plan", 0, ORIGIN, line, PLAN) if len(points) > 1 else _end("plan", 0))
            markers += _binding(scene, report, age)
        return markers

    def nothing(self) -> list[Marker]:
        """An end to all of it: nothing is heard of any of it."""
        self._names = set()
        return [_end("", 0, action=3)]

    def _drawn(self, obstacles: Sequence[Obstacle], grown: float | None) -> Iterator[Marker]:
        for each in obstacles:
            for number, part in enumerate(parts_of(each.shape)):
                yield _placed(f"obstacle {each.id}", number, each, part, OBSTACLE)
            if grown is not None and self.d_min is not None:
                for number, part in enumerate(parts_of(each.shape, self.d_min + max(0.0, grown))):
                    yield _placed(f"margin {each.id}", number, each, part, MARGIN)


def _binding(scene: Scene | None, report: ControlReport, age: float) -> list[Marker]:
    """From the ghost to the obstacle that binds, and how near the robot said it is."""
    found = [each for each in scene.obstacles if each.id == report.binding] if scene is not None else []
    if not found or not report.intervening:
        return [_end("binding", number) for number in (0, 1)]
    (x, y, z), (to_x, to_y, to_z) = report.predicted, moved(found[0], age).position
    line = Part(LINES, ORIGIN, (0.005, 0.0, 0.0), ((x, y, z), (to_x, to_y, to_z)))
    words = report.binding
    if report.clearance is not None:
        words += f": {report.clearance * 1e3:.0f} mm"
    middle = (x + to_x) / 2.0, (y + to_y) / 2.0, (z + to_z) / 2.0
    text = Part(TEXT, ORIGIN, (0.0, 0.0, 0.05))
    return [
        _marker("binding", 0, ORIGIN, line, BINDS),
        _marker("binding", 1, middle, text, BINDS)._replace(text=words),
    ]


def _placed(group: str, number: int, each: Obstacle, part: Part, color: Color) -> Marker:
    at = out_of(rotation(each.orientation), each.position, part.offset)
    return _marker(group, number, at, part, color)._replace(orientation=each.orientation)


def _marker(group: str, number: int, position: Vector3, part: Part, color: Color) -> Marker:
    return Marker(group, number, part.kind, position, UPRIGHT, part.scale, color, part.points)


def _end(group: str, number: int, action: int = 2) -> Marker:
    return Marker(group, number, CUBE, ORIGIN, UPRIGHT, ORIGIN, OBSTACLE, action=action)


def planned(report: ControlReport, command: VelocityCommand | None) -> tuple[Vector3, ...]:
    """Where the tool will be by the newest command, to the stop at its end (m); empty: none drives."""
    if command is None or command.mode != "run":
        return ()
    at, dt = report.predicted, command.plan_period_ns * 1e-9
    points = [at]
    for v in (command.velocity, *command.plan):
        at = (at[0] + v[0] * dt, at[1] + v[1] * dt, at[2] + v[2] * dt)
        points.append(at)
    return tuple(points)


def _cube(side: float) -> Vector3:
    return side, side, side


def _point(row: Any) -> Vector3:
    return float(row[0]), float(row[1]), float(row[2])
