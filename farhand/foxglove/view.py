"""A run in Foxglove's well-known schemas, tick by tick: what a recording holds and what a live server sends."""

from collections.abc import Iterator
from typing import Any

import msgspec
from foxglove.messages import (
    Color,
    CompressedImage,
    Event,
    FrameTransforms,
    JointStates,
    KeyValuePair,
    Log,
    LogLevel,
    PosesInFrame,
    SceneEntity,
    SceneEntityDeletion,
    SceneEntityDeletionType,
    SceneUpdate,
)

from farhand.common.geometry import norm
from farhand.common.messages.camera import CameraFrame
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.common.recording.decoded import DecodedTick
from farhand.common.recording.json_view import Said, View
from farhand.common.recording.mcap_file import ChannelSpec
from farhand.common.recording.records import RunInfo
from farhand.common.shapes.obstacle import Obstacle, moved
from farhand.common.shapes.sphere import Sphere
from farhand.foxglove.body import Body, transform
from farhand.foxglove.figures import BASE, PREDICTED, Place, entity, pose, stamp
from farhand.foxglove.happenings import Happening, Happenings

JOINTS, FRAMES, SCENE, PLAN, LOG, EVENTS, SCALARS, CAMERA = (
    "/joints",
    "/tf",
    "/scene",
    "/plan",
    "/log",
    "/events",
    "/scalars",
    "/camera",
)
_KINDS: dict[str, Any] = {
    JOINTS: JointStates,
    FRAMES: FrameTransforms,
    SCENE: SceneUpdate,
    PLAN: PosesInFrame,
    LOG: Log,
    EVENTS: Event,
    CAMERA: CompressedImage,
}
MOVES_EVERY_NS = 50_000_000
"""Frames and movers are told so often: what draws needs no more."""
AGAIN_NS = 1_000_000_000
"""What stands is told so often, for a viewer that begins in the middle."""
_OBSTACLE = Color(r=0.85, g=0.45, b=0.2, a=0.9)
_SHELL = Color(r=0.95, g=0.75, b=0.2, a=0.22)
_TARGET = Color(r=0.2, g=0.65, b=0.35, a=0.9)
_GHOST = Color(r=0.3, g=0.55, b=0.95, a=0.35)
TARGET_RADIUS = 0.012
_SCALARS_SCHEMA = {
    "type": "object",
    "properties": {
        "scalars": {
            "type": "array",
            "items": {
                "type": "object",
                "properties": {"label": {"type": "string"}, "value": {"type": "number"}},
            },
        }
    },
}


class FoxgloveView:
    """See View.

    Args:
        d_min: distance to keep (m), for the shells around obstacles.
        epoch_ns: see RunInfo.
    """

    def __init__(self, d_min: float, epoch_ns: int = 0) -> None:
        self.channels = (*(_channel(topic, kind) for topic, kind in _KINDS.items()), _scalars_channel())
        self._d_min, self._epoch_ns = d_min, epoch_ns
        self._body: Body | None = None
        self._scene: Scene | None = None
        self._scene_ns = 0
        self._shell = -1.0
        self._moved_ns = self._told_ns = -(1 << 62)
        self._happenings = Happenings()
        self._known: set[tuple[str, int]] = set()

    def tick(self, tick: DecodedTick) -> Iterator[Said]:
        """See View."""
        for arrived_ns, _, message in tick.news:
            if isinstance(message, RobotState):
                yield from self._state(message, arrived_ns)
            elif isinstance(message, Scene):
                yield from self._take_scene(message, arrived_ns)
            elif isinstance(message, RobotDescription):
                yield from self._take_description(message, arrived_ns)
        if tick.report is not None:
            yield from self._report(tick.report, tick)

    def frame(self, frame: CameraFrame, stamp_ns: int) -> Iterator[Said]:
        """See View."""
        at = stamp(stamp_ns + self._epoch_ns)
        picture = CompressedImage(timestamp=at, frame_id="camera", data=frame.jpeg, format="jpeg")
        yield CAMERA, stamp_ns, picture.encode()

    def _state(self, state: RobotState, now_ns: int) -> Iterator[Said]:
        for happening in self._happenings.state(state, now_ns):
            yield from self._told(happening)
        if self._body is None or now_ns - self._moved_ns < MOVES_EVERY_NS:
            return
        self._moved_ns = now_ns
        at_ns = now_ns + self._epoch_ns
        yield FRAMES, now_ns, FrameTransforms(transforms=self._body.frames(state, at_ns)).encode()
        if state.joints:
            yield JOINTS, now_ns, self._body.joints(state, at_ns).encode()
        movers = [each for each in self._obstacles(now_ns) if each.moves]
        if movers:
            yield self._scene_update([self._drawn(each, at_ns) for each in movers], now_ns)

    def _take_description(self, robot: RobotDescription, now_ns: int) -> Iterator[Said]:
        if self._body is None or not self._body.robot.same_robot(robot):
            self._body = Body(robot)
        yield self._scene_update(self._body.entities(now_ns + self._epoch_ns), now_ns)

    def _take_scene(self, scene: Scene, now_ns: int) -> Iterator[Said]:
        known = self._scene
        if scene.overtaken_by(known):
            return
        for happening in self._happenings.scene(scene, now_ns):
            yield from self._told(happening)
        at_ns = now_ns + self._epoch_ns
        gone = self._names() if known is not None else set()
        self._scene, self._scene_ns, self._shell = scene, now_ns, -1.0
        gone -= self._names()
        drawn = [self._drawn(each, at_ns) for each in scene.obstacles]
        drawn += [
            entity(f"target/{i}", at_ns, Sphere(TARGET_RADIUS), Place(target), _TARGET)
            for i, target in enumerate(scene.targets)
        ]
        yield self._scene_update(drawn, now_ns, gone)

    def _report(self, report: ControlReport, tick: DecodedTick) -> Iterator[Said]:
        now_ns = tick.record.now_ns
        at_ns = now_ns + self._epoch_ns
        ghost = [transform(PREDICTED, report.predicted, report.predicted_orientation, at_ns)]
        yield FRAMES, now_ns, FrameTransforms(transforms=ghost).encode()
        yield self._scene_update(list(self._shells(report, now_ns)), now_ns)
        yield PLAN, now_ns, self._plan(report, tick, at_ns)
        yield SCALARS, now_ns, scalars(report)
        for happening in self._happenings.tick(report, now_ns):
            yield from self._told(happening)
        for happening in self._happenings.begun:
            if (happening.kind, happening.began_ns) not in self._known:
                self._known.add((happening.kind, happening.began_ns))
                level = LogLevel.Error if happening.kind == "stop" else LogLevel.Warning
                said = Log(timestamp=stamp(at_ns), level=level, name=happening.kind, message=happening.words)
                yield LOG, now_ns, said.encode()

    def _told(self, happening: Happening) -> Iterator[Said]:
        """A happening that is over, as an event; one of an instant as a line too."""
        self._known.discard((happening.kind, happening.began_ns))
        facts = {"kind": happening.kind, "words": happening.words} | happening.facts
        event = Event(
            start_time=stamp(happening.began_ns + self._epoch_ns),
            end_time=stamp(happening.seen_ns + self._epoch_ns),
            metadata=[KeyValuePair(key=key, value=value) for key, value in facts.items()],
        )
        yield EVENTS, happening.seen_ns, event.encode()
        if happening.kind == "refused":
            at = stamp(happening.began_ns + self._epoch_ns)
            said = Log(timestamp=at, level=LogLevel.Warning, name="refused", message=happening.words)
            yield LOG, happening.began_ns, said.encode()

    def _shells(self, report: ControlReport, now_ns: int) -> Iterator[SceneEntity]:
        """What is kept around each obstacle now, where it changed or is old; and the tool where it is predicted."""
        at_ns = now_ns + self._epoch_ns
        if self._body is not None and now_ns - self._told_ns >= AGAIN_NS:
            self._told_ns = now_ns
            self._shell = -1.0
            radius = max(self._body.robot.radius, 1e-3)
            yield entity("predicted", at_ns, Sphere(radius), Place((0.0, 0.0, 0.0), frame=PREDICTED), _GHOST)
        kept = self._d_min + report.inflation
        obstacles = self._obstacles(now_ns)
        if abs(kept - self._shell) > 1e-3:
            self._shell = kept
        else:
            obstacles = [each for each in obstacles if each.moves]
        for each in obstacles:
            place = Place(each.position, each.orientation)
            yield entity(f"margin/{each.id}", at_ns, each.shape, place, _SHELL, grown=kept)

    def _plan(self, report: ControlReport, tick: DecodedTick, at_ns: int) -> bytes:
        """Where the tool will be by the command that was sent, to the stop at its end."""
        poses = []
        command = tick.command
        if command is not None and command.mode == "run":
            at, dt = report.predicted, command.plan_period_ns * 1e-9
            poses.append(pose(at))
            for v in (command.velocity, *command.plan):
                at = (at[0] + v[0] * dt, at[1] + v[1] * dt, at[2] + v[2] * dt)
                poses.append(pose(at))
        return PosesInFrame(timestamp=stamp(at_ns), frame_id=BASE, poses=poses).encode()

    def _obstacles(self, now_ns: int) -> list[Obstacle]:
        """Where they are by the newest scene, which is as old as the network made it."""
        if self._scene is None:
            return []
        seconds = (now_ns - self._scene_ns) * 1e-9
        return [moved(each, seconds) for each in self._scene.obstacles]

    def _drawn(self, each: Obstacle, at_ns: int) -> SceneEntity:
        place = Place(each.position, each.orientation)
        return entity(f"obstacle/{each.id}", at_ns, each.shape, place, _OBSTACLE, told=(("id", each.id),))

    def _names(self) -> set[str]:
        assert self._scene is not None
        names = {f"{kind}/{each.id}" for each in self._scene.obstacles for kind in ("obstacle", "margin")}
        return names | {f"target/{i}" for i in range(len(self._scene.targets))}

    def _scene_update(self, entities: list[SceneEntity], now_ns: int, gone: Any = ()) -> Said:
        at = stamp(now_ns + self._epoch_ns)
        deletions = [
            SceneEntityDeletion(timestamp=at, type=SceneEntityDeletionType.MatchingId, id=name)
            for name in sorted(gone)
        ]
        return SCENE, now_ns, SceneUpdate(deletions=deletions, entities=entities).encode()


def views_of(info: RunInfo) -> list[View]:
    """What a recording of a run tells beside the ticks' bytes."""
    controller = info.scenario.get("controller")
    d_min = controller.get("d_min") if isinstance(controller, dict) else None
    return [FoxgloveView(float(d_min) if isinstance(d_min, (int, float)) else 0.0, info.epoch_ns)]


def scalars(report: ControlReport) -> bytes:
    """What is worth a plot: m, m/s, s."""
    values: dict[str, float | None] = {
        "clearance": report.clearance,
        "margin": report.inflation,
        "speed_asked": norm(report.desired),
        "speed_done": norm(report.filtered),
        "turn_asked": norm(report.desired_angular),
        "turn_done": norm(report.angular),
        "round_trip": report.rtt,
        "loss": report.loss,
        "age": report.age,
        "state_age": report.state_age,
        "prediction_error": report.prediction_error,
        "solve_time": report.solve_time,
        "intervening": float(report.intervening),
    }
    values |= {f"margin_{name}": value for name, value in report.margin_parts.items()}
    told = [
        {"label": label, "value": float(f"{value:.6g}")}
        for label, value in values.items()
        if value is not None
    ]
    return msgspec.json.encode({"scalars": told})


def _channel(topic: str, kind: Any) -> ChannelSpec:
    schema = kind.get_schema()
    return ChannelSpec(topic, "protobuf", schema.name, schema.encoding, schema.data)


def _scalars_channel() -> ChannelSpec:
    return ChannelSpec(SCALARS, "json", "farhand.Scalars", "jsonschema", msgspec.json.encode(_SCALARS_SCHEMA))
