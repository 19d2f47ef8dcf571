"""A short recording of a UR5, written by hand: it swings, is filtered, guarded, stopped and refused something."""

import io
import math
from dataclasses import dataclass, field

import numpy as np
import pinocchio as pin
from foxglove.messages import CompressedImage, Timestamp
from PIL import Image

from farhand.common.messages.codec import encode
from farhand.common.messages.intervention import Intervention
from farhand.common.recording.fates import Fate
from farhand.common.recording.mcap_file import ChannelSpec
from farhand.common.recording.records import RunInfo, TickRecord
from farhand.common.recording.run_file import RunFile
from farhand.common.shapes.box import Box
from farhand.foxglove.view import views_of
from farhand.robot_side.arm.model import model
from farhand.testing import OPERATOR_SESSION, command, description, obstacle, report, scene, state

START_NS, TICK_NS, STATE_NS = 1_000_000_000, 100_000_000, 20_000_000
TICKS = 120
EPOCH_NS = 1_790_000_000_000_000_000
JOINTS = ("pan", "lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
HOME = (-0.85, -1.35, 1.67, -1.89, -1.57, -0.85)
D_MIN = 0.01
INTERVENING, STOPPED, GUARDED, REFUSED = range(40, 60), range(70, 75), range(80, 84), 90
SIZE = (64, 48)
OBSTACLES = (
    obstacle("ball", position=(0.45, 0.0, 0.35), radius=0.07),
    obstacle("crate", position=(0.6, 0.3, 0.1), shape=Box((0.1, 0.05, 0.2))),
)


@dataclass
class Made:
    """What was written."""

    states: list = field(default_factory=list)
    reports: list = field(default_factory=list)
    commands: list = field(default_factory=list)
    fates: list = field(default_factory=list)
    images: list = field(default_factory=list)


def info(**fields):
    scenario = {
        "name": "made",
        "description": "UR5 swings past a ball",
        "controller": {"period": TICK_NS * 1e-9, "d_min": D_MIN},
    }
    defaults = {"scenario": scenario, "robot": "ur5", "session": OPERATOR_SESSION, "seed": 4, "versions": {}}
    return RunInfo(**(defaults | {"clock": "real", "epoch_ns": EPOCH_NS, "git": "abc"} | fields))


def joints_at(t):
    return tuple(q + 0.2 * math.sin((0.7 + 0.1 * i) * t + i) for i, q in enumerate(HOME))


def wave(t, size):
    return tuple(size * math.sin(w * t + w) for w in (0.9, 1.3, 1.7))


class Camera:
    """A view with a picture every second tick."""

    def __init__(self, made):
        schema = CompressedImage.get_schema()
        self.channels = (ChannelSpec("/camera", "protobuf", schema.name, schema.encoding, schema.data),)
        self._made = made

    def tick(self, tick):
        if tick.record.number % 2 == 0:
            now_ns, buffer = tick.record.now_ns, io.BytesIO()
            rng = np.random.default_rng(tick.record.number)
            picture = np.kron(rng.integers(0, 255, (6, 8, 3), dtype=np.uint8), np.ones((8, 8, 1), np.uint8))
            Image.fromarray(picture).save(buffer, "jpeg", quality=95)
            self._made.images.append(picture)
            at = Timestamp(sec=now_ns // 10**9, nsec=now_ns % 10**9)
            image = CompressedImage(timestamp=at, frame_id="camera", data=buffer.getvalue(), format="jpeg")
            yield "/camera", now_ns, image.encode()


def make_run(path, *, ticks=TICKS, camera=False, left_out=(), **fields):
    """Write it; returns what was written."""
    made, about = Made(), info(**fields)
    file = RunFile(path, about, [*views_of(about), *([Camera(made)] if camera else [])])
    arm = model("ur5")
    for number in range(ticks):
        now_ns = START_NS + number * TICK_NS
        if number not in left_out:
            _tick(file, made, arm, number, now_ns)
    file.close()
    return made


def _tick(file, made, arm, number, now_ns):
    packets = []
    if number % 10 == 1:
        about = description(number, kind="ur5", model="ur5", joint_names=JOINTS, radius=0.05)
        packets.append(("farhand/ur5/description", now_ns - 9_000_000, encode(about)))
        packets.append(
            (
                "farhand/ur5/scene",
                now_ns - 8_000_000,
                encode(scene(number, *OBSTACLES, targets=((0.4, 0.3, 0.3),))),
            )
        )
    for i in range(TICK_NS // STATE_NS):
        arrived_ns = now_ns - (TICK_NS - (i + 1) * STATE_NS) - 1_000_000
        if number:
            packets.append(("farhand/ur5/state", arrived_ns, _state(made, arm, number, arrived_ns)))
            file.fate(_fate(made, len(made.states), arrived_ns), EPOCH_NS)
    t = number * TICK_NS * 1e-9
    stopped = number in STOPPED or number == 0
    sent = command(
        number,
        "hold" if stopped else "run",
        velocity=(0.0, 0.0, 0.0) if stopped else wave(t, 0.08),
        plan=() if stopped else (wave(t, 0.04), wave(t, 0.01)),
        desired=wave(t, 0.1),
    )
    made.commands.append(sent)
    tick = _report(made, number, t, stopped)
    made.reports.append(tick)
    file.tick(TickRecord(number, now_ns, tuple(packets), encode(sent), encode(tick)))


def _state(made, arm, number, arrived_ns):
    t = (arrived_ns - START_NS) * 1e-9
    joints = joints_at(t)
    turned, at = arm.tool_pose(np.array(joints))
    one = state(
        len(made.states),
        source="ur5",
        position=tuple(float(x) for x in at),
        orientation=quaternion(turned),
        velocity=wave(t, 0.07),
        angular_velocity=wave(t + 1.0, 0.2),
        joints=joints,
        applied_session=OPERATOR_SESSION,
        applied_seq=max(0, number - 2),
        applied_for_ns=(len(made.states) % 5) * STATE_NS,
        clearance=0.2 + 0.1 * math.sin(t),
        min_clearance=0.1,
        refused={"stale": 3} if number >= REFUSED else {},
    )
    made.states.append(one)
    return encode(one)


def quaternion(turned):
    """(w, x, y, z) of a rotation matrix."""
    x, y, z, w = (float(v) for v in pin.Quaternion(turned).coeffs())
    return w, x, y, z


def _report(made, number, t, stopped):
    seen = made.states[-1] if made.states else None
    known = (
        {
            "position": seen.position,
            "orientation": seen.orientation,
            "predicted": tuple(p + 0.01 * v for p, v in zip(seen.position, seen.velocity, strict=True)),
            "predicted_orientation": seen.orientation,
            "clearance": seen.clearance,
            "min_clearance": seen.min_clearance,
        }
        if seen is not None
        else {}
    )
    guard = Intervention(
        part="elbow", obstacle="ball", distance=0.05, limit=0.04, asked=0.1, done=0.05, what="slowed"
    )
    return report(
        number,
        mode="hold" if stopped else "run",
        desired=wave(t, 0.1),
        filtered=(0.0, 0.0, 0.0) if stopped else wave(t, 0.08),
        intervening=number in INTERVENING,
        binding="ball" if number in INTERVENING else "",
        stop_reason="robot stopped: too long without a command" if stopped else "",
        inflation=0.02 + 0.01 * math.sin(t),
        margin_parts={"floor": 0.01, "lag": 0.01 + 0.01 * math.sin(t)},
        rtt=0.04,
        state_age=0.01 + 0.005 * math.sin(3 * t),
        states=len(made.states),
        guard=guard if number in GUARDED else None,
        **known,
    )


def _fate(made, number, arrived_ns):
    lost = number % 17 == 0
    one = Fate(
        direction="downlink",
        key="farhand/ur5/state",
        number=number - 1,
        size=300,
        arrived_ns=arrived_ns,
        drawn_ns=10_000_000,
        assigned_ns=10_000_000,
        achieved_ns=-1 if lost else 10_100_000,
        fate="loss" if lost else "delivered",
    )
    made.fates.append(one)
    return one
