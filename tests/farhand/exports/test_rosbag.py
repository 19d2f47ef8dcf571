"""The ROS 2 bag: `rosbags`, which knows nothing of us, reads what was sent."""

import numpy as np
import pytest
from rosbags.highlevel import AnyReader

from farhand.exports.export import run_export
from farhand.exports.rosbag import TOPICS
from tests.farhand.made_run import (
    EPOCH_NS,
    INTERVENING,
    JOINTS,
    OBSTACLES,
    START_NS,
    STOPPED,
    TICK_NS,
    TICKS,
    make_run,
)


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bag")
    made = make_run(folder / "made.mcap", camera=True)
    assert run_export([folder / "made.mcap"], "rosbag2", folder / "out") == 0
    assert {each.name for each in (folder / "out").iterdir()} == {"metadata.yaml", "out.mcap"}
    found = {topic: [] for topic in TOPICS}
    with AnyReader([folder / "out"]) as reader:
        assert {each.topic: each.msgtype for each in reader.connections} == TOPICS
        for connection, time_ns, raw in reader.messages():
            found[connection.topic].append((time_ns, reader.deserialize(raw, connection.msgtype)))
    return found, made


def xyz(v):
    return v.x, v.y, v.z


def stamp(message):
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def test_asked_filtered_states_and_joints_are_those_of_the_run(bag):
    found, made = bag
    assert [xyz(m.twist.linear) for _, m in found["/asked"]] == [each.desired for each in made.reports]
    assert [xyz(m.twist.linear) for _, m in found["/filtered"]] == [each.filtered for each in made.reports]
    assert [at for at, _ in found["/asked"]] == [EPOCH_NS + START_NS + i * TICK_NS for i in range(TICKS)]
    assert all(
        at == stamp(message) for topic in ("/asked", "/plan", "/tool/pose") for at, message in found[topic]
    )
    assert [xyz(m.pose.position) for _, m in found["/tool/pose"]] == [each.position for each in made.states]
    assert {tuple(m.name) for _, m in found["/joint_states"]} == {JOINTS}
    assert np.array([m.position for _, m in found["/joint_states"]]) == pytest.approx(
        np.array([each.joints for each in made.states])
    )


def test_the_plan_ends_at_its_stop_and_frames_and_markers_are_where_they_are(bag):
    found, made = bag
    plans = {round((at - EPOCH_NS - START_NS) / TICK_NS): message for at, message in found["/plan"]}
    sent, seen = made.commands[20], made.reports[20]
    end = np.array(seen.predicted) + 0.1 * np.sum([sent.velocity, *sent.plan], axis=0)
    assert xyz(plans[20].poses[-1].pose.position) == pytest.approx(end)
    assert len(plans[STOPPED[1]].poses) == 0
    frames = {t.child_frame_id for _, m in found["/tf"] for t in m.transforms}
    assert {"tool", "predicted", "forearm_link"} <= frames
    markers = found["/obstacles"][0][1].markers
    assert markers[0].action == 3  # all that was there before goes
    assert [m.ns for m in markers[1:]] == [each.id for each in OBSTACLES]
    assert xyz(markers[1].pose.position) == OBSTACLES[0].position
    assert xyz(markers[1].scale) == pytest.approx((0.14, 0.14, 0.14))
    assert xyz(markers[2].scale) == pytest.approx((0.2, 0.1, 0.4))


def test_reasons_and_pictures_are_there(bag):
    found, made = bag
    lines = [message.msg for _, message in found["/rosout"]]
    assert any("the filter intervenes for ball" in line for line in lines)
    assert any("too long without a command" in line for line in lines)
    levels = [message.status[0].level for _, message in found["/diagnostics"]]
    assert [i for i, level in enumerate(levels) if level == 1] == list(INTERVENING)
    assert [i for i, level in enumerate(levels) if level == 2] == [0, *STOPPED]
    assert len(found["/camera/compressed"]) == len(made.images)
    assert bytes(found["/camera/compressed"][0][1].data[:2]) == b"\xff\xd8"


def test_several_runs_are_a_bag_each(tmp_path):
    for name in ("a", "b"):
        make_run(tmp_path / f"{name}.mcap", ticks=12)
    assert run_export([tmp_path / "a.mcap", tmp_path / "b.mcap"], "rosbag2", tmp_path / "out") == 0
    for name in ("a", "b"):
        with AnyReader([tmp_path / "out" / name]) as reader:
            assert sum(1 for each in reader.messages() if each[0].topic == "/asked") == 12
