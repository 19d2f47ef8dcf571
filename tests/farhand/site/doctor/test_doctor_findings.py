"""The doctor on loopback: each planted fault is found and the remedy said."""

import json
import socket

import pytest

from farhand.common.link.presence import Presence, about
from farhand.common.link.zenoh_link import open_session
from farhand.netem.check.check import free_ports
from farhand.runs.scenario import load_scenario
from farhand.site.doctor.doctor import examine, run_doctor
from farhand.site.doctor.facts import judge
from farhand.site.doctor.path import Answers, judge_path

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
    presence = Presence(session, "box", "robot")
    try:
        found = examine(endpoint, "ur5", "", SCENARIO, 1)
        assert worst(found) == [("robot", True)]
        assert "box" in found[-1].found
        found = examine(endpoint, "box", "", SCENARIO, 5)
        assert worst(found) == [("states", True)]
        assert any(f.what == "round trip" and f.level == "good" for f in found)
    finally:
        del presence
        session.close()


def test_a_slow_and_a_lossy_path_and_another_schema():
    slow = judge_path(Answers(10, (1.4,) * 10, {}), SCENARIO)
    assert worst(slow) == [("round trip", True)]
    lossy = judge_path(Answers(100, (0.02,) * 30, {}), SCENARIO)
    assert worst(lossy) == [("loss", True)]
    nearly = judge_path(Answers(100, (0.02,) * 99, {}), SCENARIO)
    assert worst(nearly) == []


def test_what_programs_say_of_themselves():
    own = about("doctor")
    there = own | {"certificate": "netem.lab", "days_left": 200.0}
    assert worst(judge("emulator", there, own)) == []
    for change, what, level in (
        ({"schema": 99}, "schema", "bad"),
        ({"farhand": "9"}, "versions", "note"),
        ({"realtime": False}, "scheduling", "note"),
        ({"days_left": 12.3}, "certificate", "note"),
        ({"days_left": -2.0}, "certificate", "bad"),
        ({"utc": own["utc"] - 5 * 86_400}, "clock", "note"),
    ):
        found = judge("emulator", there | change, own | {"realtime": True})
        hit = [f for f in found if f.what == f"{what}, emulator"]
        assert [f.level for f in hit] == [level], what
        assert hit[0].remedy
    clock = judge("robot", there | {"utc": own["utc"] + 5 * 86_400}, own)
    assert any("5 days ahead" in f.found for f in clock)
    assert any("clock" in f.remedy for f in judge("robot", there | {"days_left": -1.0}, own))
    assert any("12 days left" in f.found for f in judge("robot", there | {"days_left": 12.3}, own))


def test_the_table_is_for_80_columns_and_says_what_to_do(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    endpoint = f"tcp/127.0.0.1:{free_ports(1)[0]}"
    assert run_doctor(endpoint, "ur5", "", SCENARIO, 1, as_json=False) == 1
    printed = capsys.readouterr().out
    assert max(map(len, printed.splitlines())) <= 80
    assert "→ start the program there" in printed
    assert "1 of this is in the way" in printed
    assert run_doctor(endpoint, "ur5", "", SCENARIO, 1, as_json=True) == 1
    assert json.loads(capsys.readouterr().out)[-1]["level"] == "bad"
