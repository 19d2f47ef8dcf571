"""A ROS 2 bag (MCAP) of a run in standard messages, for `ros2 bag play`, RViz, PlotJuggler and `rosbags`."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from farhand.common.messages.base import Quaternion, Vector3
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.common.recording.decoded import DecodedTick
from farhand.exports.images import Image
from farhand.exports.ros_messages import ERROR, WARN, Ros
from farhand.exports.source import Run, Source, has_pictures
from farhand.foxglove.body import Body
from farhand.foxglove.figures import PREDICTED, TOOL
from farhand.foxglove.happenings import Happening, Happenings

PICTURES = "/camera/compressed"
TOPICS = {
    "/joint_states": "sensor_msgs/msg/JointState",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/tool/pose": "geometry_msgs/msg/PoseStamped",
    "/tool/twist": "geometry_msgs/msg/TwistStamped",
    "/predicted/pose": "geometry_msgs/msg/PoseStamped",
    "/asked": "geometry_msgs/msg/TwistStamped",
    "/filtered": "geometry_msgs/msg/TwistStamped",
    "/plan": "nav_msgs/msg/Path",
    "/obstacles": "visualization_msgs/msg/MarkerArray",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
    "/rosout": "rcl_interfaces/msg/Log",
    PICTURES: "sensor_msgs/msg/CompressedImage",
}
"""What is in the bag. In virtual time stamps are those of the operator's clock, from 1 s on."""
Said = Iterator[tuple[str, int, Any]]


def write_bag(runs: Sequence[Run], folder: Path) -> list[Source]:
    """Write a bag, or one a run in folders of their names; returns what was read of each.

    Raises:
        RunFileError: a recording cannot be read.
    """
    if len(runs) == 1:
        folder.rmdir()  # the writer makes it
        return [_bag(runs[0], folder)]
    return [_bag(run, folder / run.name) for run in runs]


def _bag(run: Run, folder: Path) -> Source:
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    source = Source(run)
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as bag:
        bag.set_custom_data("farhand", source.info.git or source.info.versions.get("farhand", ""))
        filmed = has_pictures(run)
        ways = {
            topic: bag.add_connection(topic, kind, typestore=store)
            for topic, kind in TOPICS.items()
            if topic != PICTURES or filmed
        }
        for topic, time_ns, message in _Story(source, Ros(store.types)).said():
            bag.write(ways[topic], time_ns, store.serialize_cdr(message, TOPICS[topic]))
    return source


class _Story:
    """Args:
    source: the run.
    ros: makes messages.
    """

    def __init__(self, source: Source, ros: Ros) -> None:
        self._source, self._ros = source, ros
        self._epoch_ns = source.info.epoch_ns
        self._body: Body | None = None
        self._happenings = Happenings()
        self._scene: Scene | None = None
        self._told: set[tuple[str, int]] = set()

    def said(self) -> Said:
        """All messages: topic, time, message."""
        for item in self._source.items(camera=True):
            if isinstance(item, Image):
                yield PICTURES, item.log_ns, self._ros.image(item.log_ns, item.format, item.data)
            elif isinstance(item, DecodedTick):
                yield from self._tick(item)

    def _tick(self, tick: DecodedTick) -> Said:
        for arrived_ns, _, message in tick.news:
            at_ns = arrived_ns + self._epoch_ns
            if isinstance(message, RobotDescription):
                if self._body is None or not self._body.robot.same_robot(message):
                    self._body = Body(message)
            elif isinstance(message, Scene) and not message.overtaken_by(self._scene):
                self._scene = message
                yield "/obstacles", at_ns, self._ros.obstacles(at_ns, message.obstacles)
            elif isinstance(message, RobotState):
                yield from self._state(message, arrived_ns)
        if tick.report is not None:
            yield from self._report(tick.report, tick)

    def _state(self, state: RobotState, arrived_ns: int) -> Said:
        at_ns, ros = arrived_ns + self._epoch_ns, self._ros
        yield "/tool/pose", at_ns, ros.pose_stamped(at_ns, state.position, state.orientation)
        yield "/tool/twist", at_ns, ros.twist(at_ns, state.velocity, state.angular_velocity)
        frames: list[tuple[str, Vector3, Quaternion]] = [(TOOL, state.position, state.orientation)]
        if self._body is not None:
            frames += self._body.links(state)
            if state.joints:
                names = self._body.joint_names(len(state.joints))
                yield "/joint_states", at_ns, ros.joints(at_ns, names, state)
        yield "/tf", at_ns, ros.frames(at_ns, frames)
        for happening in self._happenings.state(state, arrived_ns):
            yield from self._line(happening)

    def _report(self, report: ControlReport, tick: DecodedTick) -> Said:
        now_ns, ros = tick.record.now_ns, self._ros
        at_ns = now_ns + self._epoch_ns
        yield "/asked", at_ns, ros.twist(at_ns, report.desired, report.desired_angular)
        yield "/filtered", at_ns, ros.twist(at_ns, report.filtered, report.angular)
        yield "/diagnostics", at_ns, ros.diagnostics(at_ns, self._source.info.robot, report)
        if report.states:
            yield (
                "/predicted/pose",
                at_ns,
                ros.pose_stamped(at_ns, report.predicted, report.predicted_orientation),
            )
            ghost = (PREDICTED, report.predicted, report.predicted_orientation)
            yield "/tf", at_ns, ros.frames(at_ns, [ghost])
            points = planned(report, tick.command)
            yield "/plan", at_ns, ros.path(at_ns, points, report.predicted_orientation)
        for _ in self._happenings.tick(report, now_ns):
            pass  # told when they began
        for happening in self._happenings.begun:
            if (happening.kind, happening.began_ns) not in self._told:
                self._told.add((happening.kind, happening.began_ns))
                yield from self._line(happening)

    def _line(self, happening: Happening) -> Said:
        at_ns = happening.began_ns + self._epoch_ns
        level = ERROR if happening.kind == "stop" else WARN
        yield "/rosout", at_ns, self._ros.log(at_ns, level, happening.kind, happening.words)


def planned(report: ControlReport, command: VelocityCommand | None) -> list[Vector3]:
    """Where the tool will be by the command that was sent, to the stop at its end (m); empty: none drives."""
    if command is None or command.mode != "run":
        return []
    at, dt = report.predicted, command.plan_period_ns * 1e-9
    points = [at]
    for v in (command.velocity, *command.plan):
        at = (at[0] + v[0] * dt, at[1] + v[1] * dt, at[2] + v[2] * dt)
        points.append(at)
    return points
