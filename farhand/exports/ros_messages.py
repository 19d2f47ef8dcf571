"""What is said of a run in ROS 2's standard messages."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from farhand.common.messages.base import Quaternion, Vector3
from farhand.common.messages.report import ControlReport
from farhand.common.messages.state import RobotState
from farhand.common.shapes.box import Box
from farhand.common.shapes.capsule import Capsule
from farhand.common.shapes.mesh import Mesh
from farhand.common.shapes.obstacle import Obstacle
from farhand.common.shapes.pose import out_of, rotation
from farhand.common.shapes.sphere import Sphere

NANOSECONDS = 1_000_000_000
BASE = "base"
WARN, ERROR = 30, 40
"""Levels of rcl_interfaces/msg/Log."""
PLANE_SIZE, PLANE_THICKNESS = 3.0, 0.004
"""m: as much of a half-space as is drawn."""
Color = tuple[float, float, float, float]
OBSTACLE: Color = (0.85, 0.45, 0.2, 0.9)


class Ros:
    """Makes messages.

    Args:
        types: of a `rosbags` typestore, by name.
    """

    def __init__(self, types: Any) -> None:
        self._types = types

    def make(self, kind: str, /, **fields: Any) -> Any:
        """A message of a kind such as `geometry_msgs/msg/Vector3`."""
        return self._types[kind](**fields)

    def header(self, time_ns: int, frame: str = BASE) -> Any:
        """A header of an instant (ns)."""
        return self.make("std_msgs/msg/Header", stamp=self.time(time_ns), frame_id=frame)

    def time(self, time_ns: int) -> Any:
        """An instant (ns)."""
        sec, nanosec = divmod(time_ns, NANOSECONDS)
        return self.make("builtin_interfaces/msg/Time", sec=sec, nanosec=nanosec)

    def vector(self, v: Vector3) -> Any:
        """A vector."""
        return self.make("geometry_msgs/msg/Vector3", x=v[0], y=v[1], z=v[2])

    def pose(self, position: Vector3, orientation: Quaternion) -> Any:
        """A pose, from a quaternion (w, x, y, z)."""
        w, x, y, z = orientation
        return self.make(
            "geometry_msgs/msg/Pose",
            position=self.make("geometry_msgs/msg/Point", x=position[0], y=position[1], z=position[2]),
            orientation=self.make("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w),
        )

    def pose_stamped(self, time_ns: int, position: Vector3, orientation: Quaternion) -> Any:
        """A pose in base."""
        return self.make(
            "geometry_msgs/msg/PoseStamped",
            header=self.header(time_ns),
            pose=self.pose(position, orientation),
        )

    def twist(self, time_ns: int, linear: Vector3, angular: Vector3) -> Any:
        """A twist about base's axes (m/s, rad/s)."""
        twist = self.make("geometry_msgs/msg/Twist", linear=self.vector(linear), angular=self.vector(angular))
        return self.make("geometry_msgs/msg/TwistStamped", header=self.header(time_ns), twist=twist)

    def joints(self, time_ns: int, names: Iterable[str], state: RobotState) -> Any:
        """Positions (rad); velocities and efforts are not known."""
        return self.make(
            "sensor_msgs/msg/JointState",
            header=self.header(time_ns),
            name=list(names),
            position=np.array(state.joints, dtype=np.float64),
            velocity=np.array([], dtype=np.float64),
            effort=np.array([], dtype=np.float64),
        )

    def frames(self, time_ns: int, frames: Iterable[tuple[str, Vector3, Quaternion]]) -> Any:
        """Frames in base."""
        found = []
        for name, position, (w, x, y, z) in frames:
            transform = self.make(
                "geometry_msgs/msg/Transform",
                translation=self.vector(position),
                rotation=self.make("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w),
            )
            found.append(
                self.make(
                    "geometry_msgs/msg/TransformStamped",
                    header=self.header(time_ns),
                    child_frame_id=name,
                    transform=transform,
                )
            )
        return self.make("tf2_msgs/msg/TFMessage", transforms=found)

    def path(self, time_ns: int, points: Iterable[Vector3], orientation: Quaternion) -> Any:
        """Where the tool will be."""
        poses = [self.pose_stamped(time_ns, point, orientation) for point in points]
        return self.make("nav_msgs/msg/Path", header=self.header(time_ns), poses=poses)

    def log(self, time_ns: int, level: int, name: str, words: str) -> Any:
        """A line."""
        return self.make(
            "rcl_interfaces/msg/Log",
            stamp=self.time(time_ns),
            level=level,
            name=name,
            msg=words,
            file="",
            function="",
            line=0,
        )

    def diagnostics(self, time_ns: int, robot: str, report: ControlReport) -> Any:
        """What stops, binds or holds, with the numbers behind it."""
        words = report.stop_reason or (
            f"the filter intervenes for {report.binding}" if report.intervening else ""
        )
        values = {
            "clearance (m)": report.clearance,
            "margin (m)": report.inflation,
            "round trip (s)": report.rtt,
            "loss": report.loss,
            "state age (s)": report.state_age,
            "solve time (s)": report.solve_time,
        }
        told = [
            self.make("diagnostic_msgs/msg/KeyValue", key=key, value=f"{value:.6g}")
            for key, value in values.items()
            if value is not None
        ]
        level = 2 if report.stop_reason else 1 if report.intervening else 0
        status = self.make(
            "diagnostic_msgs/msg/DiagnosticStatus",
            level=level,
            name="farhand/operator",
            message=words or "ok",
            hardware_id=robot,
            values=told,
        )
        return self.make("diagnostic_msgs/msg/DiagnosticArray", header=self.header(time_ns), status=[status])

    def obstacles(self, time_ns: int, obstacles: Iterable[Obstacle]) -> Any:
        """What is to be avoided; what was there before is taken away first."""
        markers = [self._marker(time_ns, "", 0, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), kind=0, action=3)]
        for each in obstacles:
            for number, (kind, offset, scale, points) in enumerate(_parts(each)):
                at = out_of(rotation(each.orientation), each.position, offset)
                markers.append(
                    self._marker(
                        time_ns, each.id, number, at, each.orientation, kind=kind, scale=scale, points=points
                    )
                )
        return self.make("visualization_msgs/msg/MarkerArray", markers=markers)

    def _marker(  # noqa: PLR0913 (a marker has that many fields)
        self,
        time_ns: int,
        group: str,
        number: int,
        position: Vector3,
        orientation: Quaternion,
        *,
        kind: int,
        scale: Vector3 = (0.0, 0.0, 0.0),
        points: Iterable[Vector3] = (),
        action: int = 0,
    ) -> Any:
        r, g, b, a = OBSTACLE
        color = self.make("std_msgs/msg/ColorRGBA", r=r, g=g, b=b, a=a)
        return self.make(
            "visualization_msgs/msg/Marker",
            header=self.header(time_ns),
            ns=group,
            id=number,
            type=kind,
            action=action,
            pose=self.pose(position, orientation),
            scale=self.vector(scale),
            color=color,
            lifetime=self.make("builtin_interfaces/msg/Duration", sec=0, nanosec=0),
            frame_locked=False,
            points=[self.make("geometry_msgs/msg/Point", x=p[0], y=p[1], z=p[2]) for p in points],
            colors=[],
            texture_resource="",
            texture=self.make(
                "sensor_msgs/msg/CompressedImage", header=self.header(0, ""), format="", data=_NO_BYTES
            ),
            uv_coordinates=[],
            text="",
            mesh_resource="",
            mesh_file=self.make("visualization_msgs/msg/MeshFile", filename="", data=_NO_BYTES),
            mesh_use_embedded_materials=False,
        )

    def image(self, time_ns: int, form: str, data: bytes) -> Any:
        """A picture of the camera."""
        return self.make(
            "sensor_msgs/msg/CompressedImage",
            header=self.header(time_ns, "camera"),
            format=form,
            data=np.frombuffer(data, dtype=np.uint8),
        )


_NO_BYTES = np.array([], dtype=np.uint8)
CUBE, SPHERE, CYLINDER, TRIANGLES = 1, 2, 3, 11
Part = tuple[int, Vector3, Vector3, tuple[Vector3, ...]]


def _parts(each: Obstacle) -> list[Part]:
    """Kind, place in the obstacle's frame, size, and corners of the markers that draw an obstacle."""
    shape, here = each.shape, (0.0, 0.0, 0.0)
    if isinstance(shape, Sphere):
        return [(SPHERE, here, _cube(2.0 * shape.radius), ())]
    if isinstance(shape, Capsule):
        wide, ends = 2.0 * shape.radius, (-shape.half_length, shape.half_length)
        tube: Part = (CYLINDER, here, (wide, wide, 2.0 * shape.half_length), ())
        return [tube, *((SPHERE, (0.0, 0.0, end), _cube(wide), ()) for end in ends)]
    if isinstance(shape, Box):
        x, y, z = shape.half_extents
        return [(CUBE, here, (2.0 * x, 2.0 * y, 2.0 * z), ())]
    if isinstance(shape, Mesh):
        corners = Mesh(shape.vertices).hull.corners.reshape(-1, 3)
        return [(TRIANGLES, here, _cube(1.0), tuple((float(x), float(y), float(z)) for x, y, z in corners))]
    return [(CUBE, (0.0, 0.0, -PLANE_THICKNESS / 2.0), (PLANE_SIZE, PLANE_SIZE, PLANE_THICKNESS), ())]


def _cube(side: float) -> Vector3:
    return side, side, side
