"""What RViz draws: obstacles and what is kept around them, targets, the robot to come, its plan, and what binds.

Every marker ends by itself two seconds after it was told last: what nobody confirms is not shown.
"""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from farhand.common.messages.base import Quaternion, Vector3
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
from farhand.exports.ros_messages import PLANE_SIZE, PLANE_THICKNESS, Ros
from farhand.foxglove.figures import BASE, UPRIGHT

ARRAY = "visualization_msgs/msg/MarkerArray"
LIFETIME = 2
"""s; what stands is told again every second."""
TARGET_SIZE = 0.024
CUBE, SPHERE, CYLINDER, LINES, BALLS, TEXT, TRIANGLES = 1, 2, 3, 4, 7, 9, 11
Color = tuple[float, float, float, float]
OBSTACLE: Color = (0.85, 0.45, 0.2, 0.9)
MARGIN: Color = (0.95, 0.75, 0.2, 0.22)
TARGET: Color = (0.2, 0.65, 0.35, 0.9)
GHOST: Color = (0.3, 0.55, 0.95, 0.35)
PLAN: Color = (0.3, 0.55, 0.95, 0.9)
BINDS: Color = (0.95, 0.6, 0.1, 1.0)
_NO_BYTES = np.array([], dtype=np.uint8)


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
    """Args:
    ros: makes messages.

    Attributes:
        d_min: distance to keep (m), for the shells around obstacles, to which the reports' margin is added; None: it
            is not known, and no shell is shown.
    """

    def __init__(self, ros: Ros) -> None:
        self._ros = ros
        self.d_min: float | None = None
        self._names: set[str] = set()

    def standing(self, scene: Scene, grown: float | None, age: float, at_ns: int) -> Any:
        """Obstacles, shells and targets, and the ends of those that are no more.

        Args:
            scene: the newest.
            grown: what the margin adds (m); None: not known, and no shell is shown.
            age: of the scene (s).
            at_ns: time of day.
        """
        obstacles = [moved(each, age) for each in scene.obstacles]
        markers = list(self._drawn(obstacles, grown, at_ns))
        for number, target in enumerate(scene.targets):
            markers.append(
                self._marker(
                    at_ns, "targets", number, target, Part(SPHERE, target, _cube(TARGET_SIZE)), TARGET
                )
            )
        names = {each.id for each in scene.obstacles}
        for gone in sorted(self._names - names):
            for group in (f"obstacle {gone}", f"margin {gone}"):
                markers += [self._ros_delete(at_ns, group, number) for number in range(3)]
        self._names = names
        return self._ros.make(ARRAY, markers=markers)

    def moving(self, scene: Scene | None, report: ControlReport, command: VelocityCommand | None, radius: float,
               age: float, at_ns: int) -> Any:  # fmt: skip
        """What changes with every tick: movers, the ghost, the plan, what binds.

        Args:
            scene: the newest; None: none yet.
            report: of the tick.
            command: the newest; None: none yet.
            radius: of the robot's sphere (m).
            age: of the scene (s).
            at_ns: time of day.
        """
        movers = [moved(each, age) for each in scene.obstacles if each.moves] if scene is not None else []
        markers = list(self._drawn(movers, report.inflation, at_ns))
        if report.states:
            ghost = Part(SPHERE, report.predicted, _cube(2.0 * max(radius, 1e-3)))
            markers.append(self._marker(at_ns, "ghost", 0, report.predicted, ghost, GHOST))
            points = planned(report, command)
            markers.append(
                self._marker(
                    at_ns,
                    "plan",
                    0,
                    (0.0, 0.0, 0.0),
                    Part(LINES, (0.0, 0.0, 0.0), (0.008, 0.0, 0.0), points),
                    PLAN,
                )
                if len(points) > 1
                else self._ros_delete(at_ns, "plan", 0)
            )
            markers += self._binding(scene, report, age, at_ns)
        return self._ros.make(ARRAY, markers=markers)

    def nothing(self, at_ns: int) -> Any:
        """An end to all of it: nothing is heard of any of it."""
        self._names = set()
        return self._ros.make(ARRAY, markers=[self._ros_delete(at_ns, "", 0, action=3)])

    def _drawn(self, obstacles: Sequence[Obstacle], grown: float | None, at_ns: int) -> Iterator[Any]:
        for each in obstacles:
            for number, part in enumerate(parts_of(each.shape)):
                yield self._placed(at_ns, f"obstacle {each.id}", number, each, part, OBSTACLE)
            if grown is not None and self.d_min is not None:
                for number, part in enumerate(parts_of(each.shape, self.d_min + max(0.0, grown))):
                    yield self._placed(at_ns, f"margin {each.id}", number, each, part, MARGIN)

    def _binding(self, scene: Scene | None, report: ControlReport, age: float, at_ns: int) -> list[Any]:
        """From the ghost to the obstacle that binds, and how near the robot said it is."""
        found = [each for each in scene.obstacles if each.id == report.binding] if scene is not None else []
        if not found or not report.intervening:
            return [self._ros_delete(at_ns, "binding", number) for number in (0, 1)]
        there = moved(found[0], age).position
        line = Part(LINES, (0.0, 0.0, 0.0), (0.005, 0.0, 0.0), (report.predicted, there))
        middle = tuple((a + b) / 2.0 for a, b in zip(report.predicted, there, strict=True))
        words = (
            report.binding
            if report.clearance is None
            else f"{report.binding}: {report.clearance * 1e3:.0f} mm"
        )
        text = Part(TEXT, middle, (0.0, 0.0, 0.05))  # type: ignore[arg-type]
        return [
            self._marker(at_ns, "binding", 0, (0.0, 0.0, 0.0), line, BINDS),
            self._marker(at_ns, "binding", 1, middle, text, BINDS, text=words),  # type: ignore[arg-type]
        ]

    def _placed(self, at_ns: int, group: str, number: int, each: Obstacle, part: Part, color: Color) -> Any:
        at = out_of(rotation(each.orientation), each.position, part.offset)
        return self._marker(at_ns, group, number, at, part, color, orientation=each.orientation)

    def _ros_delete(self, at_ns: int, group: str, number: int, action: int = 2) -> Any:
        here: Vector3 = (0.0, 0.0, 0.0)
        return self._marker(at_ns, group, number, here, Part(CUBE, here, here), OBSTACLE, action=action)

    def _marker(  # noqa: PLR0913 (a marker has that many fields)
        self,
        at_ns: int,
        group: str,
        number: int,
        position: Vector3,
        part: Part,
        color: Color,
        *,
        orientation: Quaternion = UPRIGHT,
        text: str = "",
        action: int = 0,
    ) -> Any:
        ros, (r, g, b, a) = self._ros, color
        header = ros.header(at_ns, BASE)
        return ros.make(
            "visualization_msgs/msg/Marker",
            header=header,
            ns=group,
            id=number,
            type=part.kind,
            action=action,
            pose=ros.pose(position, orientation),
            scale=ros.vector(part.scale),
            color=ros.make("std_msgs/msg/ColorRGBA", r=r, g=g, b=b, a=a),
            lifetime=ros.make("builtin_interfaces/msg/Duration", sec=LIFETIME, nanosec=0),
            frame_locked=False,
            points=[ros.make("geometry_msgs/msg/Point", x=p[0], y=p[1], z=p[2]) for p in part.points],
            colors=[],
            texture_resource="",
            texture=ros.make("sensor_msgs/msg/CompressedImage", header=header, format="", data=_NO_BYTES),
            uv_coordinates=[],
            text=text,
            mesh_resource="",
            mesh_file=ros.make("visualization_msgs/msg/MeshFile", filename="", data=_NO_BYTES),
            mesh_use_embedded_materials=False,
        )


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
