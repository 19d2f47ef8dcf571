"""The doctor on loopback: each planted fault is found and the remedy said."""

import json
import socket

import pytest

from common.codec import Decoder
from common.messages import RobotState
from common.presence import Presence
from common.scenario import load_scenario
from common.zenoh_link import open_session
from farhand.doctor import Answers, _path, _versions, examine
from netem.check import free_ports

pytestmark = pytest.mark.realtime
SCENARIO = load_scenario("point-obstacle")


def worst(findings):
    return [(f.what, f.remedy != "") for f in findings if f.level == "bad"]


def test_nothing_listens():
    assert worst(examine(f"tcp/127.0.0.1:{free_ports(1)[0]}", "ur5", "", SCENARIO, 1)) == [
        ("reachability", True)
    ]


def test_no_such_host():
    assert worst(examine("tcp/no-such-host.invalid:7447", "ur5", "", SCENARIO, 1)) == [("reachability", True)]


def test_something_else_listens():
    with socket.create_server(("127.0.0.1", 0)) as server:
        endpoint = f"tcp/127.0.0.1:{server.getsockname()[1]}"
        assert worst(examine(endpoint, "ur5", "", SCENARIO, 1)) == [("Zenoh", True)]


def test_another_robot_is_there_and_one_without_states():
    endpoint = f"tcp/127.0.0.1:{free_ports(1)[0]}"
    session = open_session(listen=[endpoint])
    kept = Presence(session, "box", "robot")
    try:
        found = examine(endpoint, "ur5", "", SCENARIO, 1)
        assert worst(found) == [("robot", True)]
        assert "box" in found[-1].found
        found = examine(endpoint, "box", "", SCENARIO, 5)
        assert worst(found) == [("states", True)]
        assert any(f.what == "round trip" and f.level == "good" for f in found)
    finally:
        session.close()
    assert kept.token is not None


def test_a_slow_and_a_lossy_path_and_another_schema():
    slow = _path(Answers(10, (1.4,) * 10, {}), SCENARIO)
    assert worst(slow) == [("round trip", True)]
    lossy = _path(Answers(100, (0.02,) * 30, {}), SCENARIO)
    assert worst(lossy) == [("loss", True)]
    nearly = _path(Answers(100, (0.02,) * 99, {}), SCENARIO)
    assert worst(nearly) == []
    other = _versions({"schema": 99, "farhand": "9"}, Decoder(RobotState))
    assert worst(other) == [("schema", True)]
    assert json.dumps(other[0].found)
