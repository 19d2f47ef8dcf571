"""What Farhand says, on ROS topics: joint states at once, all else in batches in a thread of its own."""

from collections import Counter, deque
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from farhand.bridges.ros2.cdr.frames import FRAMES, Frames
from farhand.bridges.ros2.cdr.joint_states import JOINT_STATE, JointStates
from farhand.bridges.ros2.cdr.marker_array import ARRAY, Marker, encode_markers
from farhand.bridges.ros2.graph.node import RosNode
from farhand.bridges.ros2.graph.wire import LATCHED, RELIABLE, ROSOUT, SENSOR
from farhand.bridges.ros2.outbound.description import ArmFrames
from farhand.bridges.ros2.outbound.joints import JointReader
from farhand.bridges.ros2.outbound.markers import LIFETIME, Markers
from farhand.bridges.ros2.outbound.status import diagnostics, servo_status, unknown
from farhand.common.link.link import Packet
from farhand.common.messages.base import Message
from farhand.common.messages.camera import CameraFrame
from farhand.common.messages.codec import Decoder
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.echo import Newest
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.common.timing.clock import to_ns
from farhand.common.timing.handoff import Handoff
from farhand.exports.ros_messages import ERROR, WARN, Ros
from farhand.foxglove.figures import BASE, PREDICTED
from farhand.foxglove.happenings import Happening, Happenings

BATCH_NS = 15_000_000
"""So long what need not be told at once is gathered; the frames of the newest state are told with each batch."""
DRAWN_EVERY_NS = 100_000_000
AGAIN_NS = 1_000_000_000
"""What stands is told so often, for who comes late; diagnostics too."""
SCENE_LOST_NS = 1_500_000_000
ASK_AGAIN_NS = 5_000_000_000
WAITING = 64
"""Batches."""
INFO = 20
KINDS: dict[str, type[Message]] = {
    "state": RobotState,
    "report": ControlReport,
    "command": VelocityCommand,
    "scene": Scene,
    "description": RobotDescription,
    "camera": CameraFrame,
}


class Outward:
    """Args:
    node: publishes.
    robot: the robot's name.
    epoch_ns: see SystemClock.
    kept: asks the operator's program for the distance to keep (m); may wait a second; None: not answered.

    Attributes:
        refused: what the bridge refused so far, by topic and reason; shown in the diagnostics.
        steers: what steers, for people.
        stands: whether robot_description and the standing frames were told.
        joint_states: their publisher.
        failed, trouble: what could not be told, and the newest reason.
        lost: what found no place because the thread of its own was too slow.
    """

    def __init__(
        self, node: RosNode, robot: str, epoch_ns: int, kept: Callable[[], float | None] = lambda: None
    ) -> None:
        self.refused: dict[str, int] = {}
        self.failed: Counter[str] = Counter()
        self.steers, self.stands, self.trouble = "", False, ""
        types = node.types
        self._types, self._ros, self._epoch_ns, self._robot = types, Ros(types.types), epoch_ns, robot
        self.joint_states = node.publisher("joint_states", JOINT_STATE, RELIABLE)
        self._frames = node.publisher("/tf", FRAMES, RELIABLE)
        self._standing = node.publisher("/tf_static", FRAMES, LATCHED)
        self._urdf = node.publisher("robot_description", "std_msgs/msg/String", LATCHED)
        self._markers = node.publisher("~/markers", ARRAY, RELIABLE)
        self._status = node.publisher("~/status", "moveit_msgs/msg/ServoStatus", RELIABLE)
        self._diagnostics = node.publisher("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", RELIABLE)
        self._rosout = node.publisher("/rosout", "rcl_interfaces/msg/Log", ROSOUT)
        self._picture = node.publisher(
            "camera/image_raw/compressed", "sensor_msgs/msg/CompressedImage", SENSOR
        )
        self._camera = node.publisher("camera/camera_info", "sensor_msgs/msg/CameraInfo", SENSOR)
        self._name = f"{node.namespace}/{node.name}".strip("/").replace("/", ".")
        self._joint_reader, self._newest = JointReader(), Newest()
        self._decoders: dict[str, Decoder[Message]] = {kind: Decoder(of) for kind, of in KINDS.items()}
        self._arm: ArmFrames | None = None
        self._encoder: JointStates | None = None
        self._encoder_of: ArmFrames | None = None
        self._story = _Story(Markers())
        self._kept, self._asked_ns = kept, -(1 << 62)
        self._told_ns = self._looked_ns = -(1 << 62)
        self._gathered: deque[tuple[str, Any, int]] = deque()
        self._newest_state: deque[tuple[str, Any, int]] = deque(maxlen=1)
        self._layouts: dict[tuple[str, ...], Frames] = {}
        self._slow: Handoff[list[tuple[str, Any, int]]] = Handoff(self._work, "ros2-out", WAITING)

    @property
    def heard(self) -> bool:
        """Whether a state has come."""
        return self._newest.seq >= 0

    @property
    def lost(self) -> int:
        """See the class."""
        return self._slow.lost

    def hand_on(self, packet: Packet, now_ns: int) -> None:
        """Take one packet of the report endpoint or of the robot's side; never waits."""
        kind = packet.key.rpartition("/")[2]
        if kind == "state":
            self.take_state(packet.payload, packet.arrived_ns)
        elif kind in KINDS:
            self._gathered.append((kind, packet.payload, packet.arrived_ns))

    def take_state(self, payload: bytes, at_ns: int) -> None:
        """Take a state that arrived at `at_ns`, always in the same thread; never waits."""
        state = self._joint_reader.read(payload)
        if state is None or not self._newest.accept(state, at_ns):
            return
        self._newest_state.append(("state", payload, at_ns))
        arm = self._arm  # until the robot has said what its joints are called, nobody else does
        if state.joints and arm is not None and self.joint_states.wanted:
            if (
                self._encoder is None
                or self._encoder_of is not arm
                or self._encoder.count != len(state.joints)
            ):
                self._encoder_of = arm
                self._encoder = JointStates(self._types, self._ros, arm.names(len(state.joints)))
            self.joint_states.put_bytes(self._encoder.encode(at_ns + self._epoch_ns, state.joints))

    def look(self, now_ns: int) -> None:
        """Let time act; never waits."""
        if now_ns - self._told_ns < BATCH_NS:
            return
        self._told_ns = now_ns
        if now_ns - self._looked_ns >= DRAWN_EVERY_NS:
            self._looked_ns = now_ns
            self._gathered.append(("look", None, now_ns))
        self._hand_over()

    def tell(self, line: str, now_ns: int) -> None:
        """A line for /rosout, from any thread; never waits."""
        self._gathered.append(("tell", line, now_ns))

    def close(self) -> None:
        """Say what waits, for a second at most."""
        self._hand_over()
        self._slow.close(1.0)

    def _hand_over(self) -> None:
        """All that is gathered, and the newest state: others append to both meanwhile."""
        batch = [each.popleft() for each in (self._gathered, self._newest_state) for _ in range(len(each))]
        if batch:
            self._slow.put(batch)

    def _work(self, batch: list[tuple[str, Any, int]]) -> None:
        """In the thread of its own, which nothing that is said may end."""
        for what in batch:
            try:
                self._do(*what)
            except Exception as error:
                self.failed[f"{what[0]} not told"] += 1
                self.trouble = f"a {what[0]} could not be told: {type(error).__name__}: {error}"

    def _do(self, kind: str, found: Any, at_ns: int) -> None:
        if kind == "look":
            self._draw(at_ns)
        elif kind == "tell":
            self._log(INFO, self._name, found, at_ns)
        else:
            message = self._decoders[kind].decode(found)
            if message is not None:
                self._take(kind, message, at_ns)

    def _take(self, kind: str, message: Message, at_ns: int) -> None:
        if isinstance(message, RobotState):
            self._take_state(message, at_ns)
        elif isinstance(message, ControlReport):
            self._take_report(message, at_ns)
        elif isinstance(message, VelocityCommand):
            self._story.command = message
        elif isinstance(message, Scene) and not message.overtaken_by(self._story.scene):
            self._story.scene, self._story.scene_ns, self._story.stood_ns = message, at_ns, -(1 << 62)
        elif isinstance(message, RobotDescription):
            if self._arm is None or not self._arm.robot.same_robot(message):
                self._describe(message)
        elif isinstance(message, CameraFrame):
            self._show(message, at_ns)

    def _take_state(self, state: RobotState, at_ns: int) -> None:
        self._story.state = state
        for happening in self._story.happenings.state(state, at_ns):
            self._happened(happening)
        if self._arm is None:
            return
        if self._story.described and state.joints:
            self._story.described, self.stands = False, True
            self._standing.put(self._ros.frames(at_ns + self._epoch_ns, self._arm.standing(state)))
        if not self._frames.wanted:
            return
        frames, report = self._arm.moving(state), self._story.report
        if report is not None and report.states:
            frames.append((PREDICTED, report.predicted, report.predicted_orientation))
        names = tuple(name for name, _, _ in frames)
        if names not in self._layouts:
            self._layouts = {names: Frames(BASE, names)}
        self._frames.put_bytes(self._layouts[names].encode(at_ns + self._epoch_ns, frames))

    def _describe(self, robot: RobotDescription) -> None:
        self._arm = ArmFrames(robot)
        self._story.described, self._story.radius = True, robot.radius
        text = self._arm.urdf()
        if text:
            self._urdf.put(self._types.make("std_msgs/msg/String", data=text))

    def _take_report(self, report: ControlReport, at_ns: int) -> None:
        story = self._story
        if story.report is None or story.report.session != report.session:
            story.markers.d_min = None  # another program, with another scenario
        story.report, story.report_ns = report, at_ns
        self._tell_status(servo_status(report, 0.0, story.state), at_ns)
        for _ in story.happenings.tick(report, at_ns):
            pass  # told when they began
        for happening in story.happenings.begun:
            if story.told.get(happening.kind) != happening.began_ns:
                story.told[happening.kind] = happening.began_ns
                self._happened(happening)

    def _draw(self, now_ns: int) -> None:
        """What is drawn and told by the clock, and an end to what is not heard of any more."""
        story, at_ns = self._story, now_ns + self._epoch_ns
        age = (now_ns - story.report_ns) * 1e-9
        scene_age_ns = now_ns - story.scene_ns
        scene = story.scene if scene_age_ns <= SCENE_LOST_NS else None
        report = story.report if not unknown(story.report, age) else None
        if report is not None and story.markers.d_min is None and now_ns - self._asked_ns > ASK_AGAIN_NS:
            self._asked_ns = now_ns
            story.markers.d_min = self._kept()
        if scene is not None and self._markers.wanted and now_ns - story.stood_ns >= AGAIN_NS:
            story.stood_ns, story.shown = now_ns, True
            grown = report.inflation if report is not None else None
            self._mark(story.markers.standing(scene, grown, scene_age_ns * 1e-9), at_ns)
        if report is not None and self._markers.wanted:
            self._mark(
                story.markers.moving(scene, report, story.command, story.radius, scene_age_ns * 1e-9), at_ns
            )
        elif report is None and scene is None and story.shown:
            story.shown = False
            self._mark(story.markers.nothing(), at_ns)
        if now_ns - story.told_ns >= to_ns(1.0):
            story.told_ns = now_ns
            if self._diagnostics.wanted:
                self._diagnose(age, at_ns)
            if report is None:
                self._tell_status(servo_status(story.report, age, story.state), now_ns)

    def _mark(self, markers: Sequence[Marker], at_ns: int) -> None:
        self._markers.put_bytes(encode_markers(at_ns, BASE, LIFETIME, markers))

    def _tell_status(self, status: tuple[int, str], now_ns: int) -> None:
        """What changed at once, and ten times a second."""
        story = self._story
        if status == story.status and now_ns - story.status_ns < DRAWN_EVERY_NS:
            return
        story.status, story.status_ns = status, now_ns
        self._status.put(self._types.make("moveit_msgs/msg/ServoStatus", code=status[0], message=status[1]))

    def _diagnose(self, age: float, at_ns: int) -> None:
        make, told = self._types.make, []
        for name, level, words, figures in diagnostics(
            self._story.report, age, self._story.state, self.refused | self.failed, self.steers
        ):
            values = [
                make(
                    "diagnostic_msgs/msg/KeyValue",
                    key=key,
                    value=f"{value:.6g}" if isinstance(value, float) else f"{value}",
                )
                for key, value in figures.items()
                if value is not None
            ]
            told.append(
                make("diagnostic_msgs/msg/DiagnosticStatus", level=level, name=f"farhand {self._robot}: {name}",
                     message=words, hardware_id=self._robot, values=values)
            )  # fmt: skip
        header = self._ros.header(at_ns, "")
        self._diagnostics.put(make("diagnostic_msgs/msg/DiagnosticArray", header=header, status=told))

    def _happened(self, happening: Happening) -> None:
        level = ERROR if happening.kind == "stop" else WARN
        self._log(level, f"{self._name}.{happening.kind}", happening.words, happening.began_ns)

    def _log(self, level: int, name: str, words: str, at_ns: int) -> None:
        self._rosout.put(self._ros.log(at_ns + self._epoch_ns, level, name, words))

    def _show(self, frame: CameraFrame, at_ns: int) -> None:
        """A picture, and what is known of the camera: its size, and that it is not calibrated."""
        at_ns += self._epoch_ns
        if self._picture.wanted:
            self._picture.put(self._ros.image(at_ns, "jpeg", frame.jpeg))
        make = self._types.make
        region = make(
            "sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
        )
        self._camera.put(
            make("sensor_msgs/msg/CameraInfo", header=self._ros.header(at_ns, "camera"), height=frame.height,
                 width=frame.width, distortion_model="", d=np.zeros(0), k=np.zeros(9), r=np.zeros(9),
                 p=np.zeros(12), binning_x=0, binning_y=0, roi=region)
        )  # fmt: skip


class _Story:
    """What the slow thread knows; nobody else looks at it."""

    def __init__(self, markers: Markers) -> None:
        self.markers, self.happenings = markers, Happenings()
        self.report: ControlReport | None = None
        self.command: VelocityCommand | None = None
        self.scene: Scene | None = None
        self.state: RobotState | None = None
        self.told: dict[str, int] = {}
        self.status: tuple[int, str] | None = None
        self.report_ns = self.scene_ns = self.stood_ns = self.told_ns = self.status_ns = -(1 << 62)
        self.described = self.shown = False
        self.radius = 0.0
