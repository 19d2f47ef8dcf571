"""What Foxglove is told of a run, read back by the schemas in the file: an independent reader, no code of ours."""

import json
import math
from collections import defaultdict

import numpy as np
import pinocchio as pin
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from farhand.common.messages.codec import encode
from farhand.common.recording.decoded import DecodedTick, TickDecoder
from farhand.common.recording.records import TickRecord
from farhand.foxglove.view import FoxgloveView
from farhand.robot_side.arm.model import model
from farhand.testing import description, scene
from tests.farhand.made_run import (
    D_MIN,
    EPOCH_NS,
    GUARDED,
    HOME,
    INTERVENING,
    JOINTS,
    OBSTACLES,
    REFUSED,
    START_NS,
    STATE_NS,
    STOPPED,
    TICK_NS,
    joints_at,
    make_run,
)

WELL_KNOWN = {
    "/joints": "foxglove.JointStates",
    "/tf": "foxglove.FrameTransforms",
    "/scene": "foxglove.SceneUpdate",
    "/plan": "foxglove.PosesInFrame",
    "/log": "foxglove.Log",
    "/events": "foxglove.Event",
    "/camera": "foxglove.CompressedImage",
}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    path = tmp_path_factory.mktemp("made") / "made.mcap"
    made = make_run(path, camera=True)
    found, schemas = defaultdict(list), {}
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for schema, channel, message in reader.iter_messages():
            if channel.topic in ("/farhand/tick",):
                continue
            schemas[channel.topic] = schema.name
            if channel.message_encoding == "json":
                found[channel.topic].append((message.log_time, json.loads(message.data)))
        for _, channel, message, decoded in reader.iter_decoded_messages(topics=list(WELL_KNOWN)):
            found[channel.topic].append((message.log_time, decoded))
    return found, schemas, made


def tick_of(log_ns):
    return round((log_ns - EPOCH_NS - START_NS) / TICK_NS)


def entities(run, prefix):
    """(time, id, entity) of every telling."""
    return [
        (at, e.id, e) for at, update in run[0]["/scene"] for e in update.entities if e.id.startswith(prefix)
    ]


def xyz(v):
    return v.x, v.y, v.z


def test_every_topic_is_there_with_foxgloves_own_schema(run):
    found, schemas, _ = run
    assert {topic: schemas.get(topic) or name for topic, name in WELL_KNOWN.items()} == WELL_KNOWN
    assert all(found[topic] for topic in WELL_KNOWN)


def test_frames_are_those_of_the_arm(run):
    found, _, _ = run
    arm, checked = model("ur5"), 0
    for at, message in found["/tf"]:
        frames = {each.child_frame_id: each for each in message.transforms}
        if "wrist_3_link" not in frames:
            continue
        t = (at - EPOCH_NS - START_NS) * 1e-9
        R, p = arm.tool_pose(np.array(joints_at(t)))
        tool = frames["tool"]
        assert xyz(tool.translation) == pytest.approx(p, abs=1e-6)
        q = pin.Quaternion(tool.rotation.w, tool.rotation.x, tool.rotation.y, tool.rotation.z)
        assert q.toRotationMatrix() == pytest.approx(R, abs=1e-5)
        rotations, origins = arm.poses(np.array(joints_at(t)))
        names = (
            "shoulder_link",
            "upper_arm_link",
            "forearm_link",
            "wrist_1_link",
            "wrist_2_link",
            "wrist_3_link",
        )
        for name, R, p in zip(names, rotations, origins, strict=True):
            assert xyz(frames[name].translation) == pytest.approx(p, abs=1e-6), name
            r = frames[name].rotation
            assert pin.Quaternion(r.w, r.x, r.y, r.z).toRotationMatrix() == pytest.approx(R, abs=1e-5), name
        assert all(each.parent_frame_id == "base" for each in message.transforms)
        checked += 1
    assert checked > 100


def test_joints_have_their_names_and_positions(run):
    for at, message in run[0]["/joints"]:
        t = (at - EPOCH_NS - START_NS) * 1e-9
        assert [each.name for each in message.joints] == list(JOINTS)
        assert [each.position for each in message.joints] == pytest.approx(joints_at(t), abs=1e-6)
    assert len(HOME) == len(JOINTS)


def test_obstacles_stand_at_their_places_in_their_sizes(run):
    told = {name: entity for _, name, entity in entities(run, "obstacle/")}
    ball, crate = told["obstacle/ball"], told["obstacle/crate"]
    assert xyz(ball.spheres[0].pose.position) == pytest.approx(OBSTACLES[0].position, abs=1e-6)
    assert xyz(ball.spheres[0].size) == pytest.approx((0.14, 0.14, 0.14), abs=1e-6)
    assert xyz(crate.cubes[0].pose.position) == pytest.approx(OBSTACLES[1].position, abs=1e-6)
    assert xyz(crate.cubes[0].size) == pytest.approx((0.2, 0.1, 0.4), abs=1e-6)
    assert {e.frame_id for e in told.values()} == {"base"}


def test_margins_grow_with_what_is_kept(run):
    shells, made = entities(run, "margin/ball"), run[2]
    for at, _, entity in shells:
        kept = D_MIN + made.reports[tick_of(at)].inflation
        assert entity.spheres[0].size.x == pytest.approx(2 * (0.07 + kept), abs=1e-6)
    sizes = {round(entity.spheres[0].size.x, 4) for *_, entity in shells}
    assert len(sizes) > 5
    newest = {}
    for at, _, entity in shells:
        newest[tick_of(at)] = entity.spheres[0].size.x
    shown = None
    for tick, report in enumerate(made.reports[2:], 2):  # what stands is never further off than a millimetre
        shown = newest.get(tick, shown)
        if shown is not None:
            assert shown / 2 - 0.07 == pytest.approx(D_MIN + report.inflation, abs=1.1e-3)


def test_the_robot_and_its_ghost_move_with_their_frames(run):
    told = {name: entity for _, name, entity in entities(run, "")}
    assert told["predicted"].frame_id == "predicted"
    assert told["robot/tool"].frame_id == "tool"
    assert told["robot/forearm_link"].frame_id == "forearm_link"
    assert all(told[name].frame_locked for name in ("predicted", "robot/tool", "robot/forearm_link"))


def test_the_plan_ends_where_the_command_stops(run):
    found, _, made = run
    for at, message in found["/plan"]:
        tick = tick_of(at)
        sent, report = made.commands[tick], made.reports[tick]
        if sent.mode != "run":
            assert not message.poses
            continue
        end = np.array(report.predicted) + 0.1 * np.sum([sent.velocity, *sent.plan], axis=0)
        assert xyz(message.poses[0].position) == pytest.approx(report.predicted, abs=1e-6)
        assert xyz(message.poses[-1].position) == pytest.approx(end, abs=1e-6)


def test_happenings_begin_and_end_and_are_said_in_words(run):
    found, _, _ = run
    events = [
        ({each.key: each.value for each in message.metadata}, message) for _, message in found["/events"]
    ]

    def span(kind, number=-1):
        _, message = [each for each in events if each[0]["kind"] == kind][number]
        begin, end = (
            at.seconds * 10**9 + at.nanos - EPOCH_NS - START_NS
            for at in (message.start_time, message.end_time)
        )
        return begin / TICK_NS, end / TICK_NS

    assert span("filter") == (INTERVENING[0], INTERVENING[-1])
    assert span("stop") == (STOPPED[0], STOPPED[-1])
    assert span("guard") == (GUARDED[0], GUARDED[-1])
    assert span("refused")[0] == pytest.approx(REFUSED - 1 + STATE_NS / TICK_NS, abs=0.2)
    lines = [(tick_of(at), line.name, line.message) for at, line in found["/log"]]
    assert (INTERVENING[0], "filter", "the filter intervenes for ball") in lines
    assert any(tick == STOPPED[0] and name == "stop" for tick, name, _ in lines)
    assert sum(name == "filter" for _, name, _ in lines) == 1


def test_scalars_are_those_of_the_reports(run):
    found, _, made = run
    for (_, message), report in zip(found["/scalars"], made.reports, strict=True):
        told = {each["label"]: each["value"] for each in message["scalars"]}
        assert told["margin"] == pytest.approx(report.inflation, abs=1e-6)
        assert told["speed_asked"] == pytest.approx(math.hypot(*report.desired), rel=1e-5, abs=1e-9)
        assert told["speed_done"] == pytest.approx(math.hypot(*report.filtered), rel=1e-5, abs=1e-9)
        assert told["margin_lag"] == pytest.approx(report.margin_parts["lag"], abs=1e-6)
        assert ("clearance" in told) == (report.clearance is not None)


def _about(number):
    about = description(number, kind="ur5", model="ur5", joint_names=JOINTS, radius=0.05)
    yield "farhand/ur5/description", number * TICK_NS, encode(about)
    yield "farhand/ur5/scene", number * TICK_NS, encode(scene(number, *OBSTACLES))


def test_a_tick_is_told_in_few_messages(run):
    """What stands is not told again in every tick; the recorder's program has a tick's time for all of it."""
    made = run[2]
    view, decoder = FoxgloveView(D_MIN), TickDecoder()
    ticks: list[DecodedTick] = []
    for number, (sent, report) in enumerate(zip(made.commands, made.reports, strict=True)):
        packets = tuple(
            ("farhand/ur5/state", number * TICK_NS, encode(made.states[min(5 * number + i, 594)]))
            for i in range(5)
        )
        if number % 10 == 1:
            packets = (*_about(number), *packets)
        ticks.append(
            decoder.decode(TickRecord(number, number * TICK_NS, packets, encode(sent), encode(report)))
        )
    said = sum(len(list(view.tick(tick))) for tick in ticks)
    assert said / len(ticks) < 10
