"""The operator's time limit: motion counts, waiting for another one's control does not."""

from types import SimpleNamespace

import pytest

from farhand.common.link.link import Packet, memory_wire
from farhand.common.messages.keys import command_key, mirror_key
from farhand.operator_side.main import MirroredLink, TimeLimit

S = 1_000_000_000
LIMIT = 10


def ends(course, limit=LIMIT, until=60):
    """When the limit is up (s); `course` says when it waits, and when it first drives."""
    node = SimpleNamespace(waits=False, driving_since_ns=None)
    time_limit = TimeLimit(node, limit * S if limit else None, 0)
    for tenth in range(1, until * 10):
        t = tenth / 10
        node.waits = any(a <= t < b for a, b in course.get("waits", ()))
        if "drives" in course and t >= course["drives"]:
            node.driving_since_ns = round(course["drives"] * S)
        if time_limit.is_up(round(t * S)):
            return t
    return None


@pytest.mark.parametrize(
    ("course", "end"),
    [
        ({}, 10.0),  # nobody answers
        ({"drives": 4.0}, 14.0),
        ({"waits": [(0.0, 30.0)]}, 40.0),
        ({"waits": [(0.0, 30.0)], "drives": 31.0}, 41.0),
        ({"waits": [(5.0, 30.0)], "drives": 31.0}, 41.0),  # what came before the wait does not count
        ({"drives": 2.0, "waits": [(5.0, 25.0)]}, 32.0),  # handed over, and back
        ({"drives": 2.0, "waits": [(5.0, 99.0)]}, None),
    ],
)
def test_only_time_in_control_counts(course, end):
    found = ends(course)
    assert found == (None if end is None else pytest.approx(end, abs=0.11))


def test_without_a_limit_nothing_ends():
    assert ends({"drives": 1.0}, limit=None) is None


def test_what_is_sent_is_mirrored_undecoded_and_what_arrives_is_for_the_node_alone():
    to_robot, robot = memory_wire()
    reports, console = memory_wire()
    link = MirroredLink(to_robot, reports, "r")
    link.send(Packet(command_key("r"), b"anything"))
    robot.send(Packet("farhand/r/state", b"state"))
    assert [packet.payload for packet in robot.receive()] == [b"anything"]
    assert [packet.payload for packet in link.receive()] == [b"state"]
    assert [(p.key, p.payload) for p in console.receive()] == [(mirror_key("r", "command"), b"anything")]
