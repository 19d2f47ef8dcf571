"""The real programs: two robots and two operators over one emulator, each with a network of its own."""

import json
import signal
import threading
from collections import deque

import pytest

from farhand.commands.netem_live import common as share
from farhand.commands.netem_live import set_network
from farhand.common.link.ports import free_ports
from farhand.common.link.zenoh_link import open_session
from farhand.common.messages.codec import Decoder
from farhand.common.messages.keys import report_key, state_key
from farhand.common.messages.report import ControlReport
from farhand.common.messages.state import RobotState
from farhand.netem.control import ask
from farhand.site.robots import list_robots
from tests.farhand.programs.test_programs_processes import Program

pytestmark = pytest.mark.realtime
PATIENCE = 60.0
SCENARIO = """
name = "far"
start = [0.0, 0.0, 0.5]
targets = [{target}]
[robot]
kind = "point"
radius = 0.05
rate_hz = 100
state_rate_hz = 50
lag = 0.1
"""
TARGETS = {"a": [30.0, 0.0, 0.5], "b": [0.0, 30.0, 0.5]}
"""So far away that nobody arrives, and each robot in a direction of its own."""


class Observed:
    """What is seen of one robot from outside: the operator's reports, the robot's states."""

    def __init__(self, name, report_endpoint, operators_session):
        self.condition = threading.Condition()
        self.trips, self.states = deque(maxlen=20), deque(maxlen=2000)
        self.reports, self.decoder = Decoder(ControlReport), Decoder(RobotState)
        self.session = open_session([report_endpoint])
        self.session.declare_subscriber(report_key(name), self.report)
        operators_session.declare_subscriber(state_key(name), self.state)

    def report(self, sample):
        found = self.reports.decode(sample.payload.to_bytes())
        with self.condition:
            if found is not None and found.rtt is not None:
                self.trips.append(found.rtt)
            self.condition.notify()

    def state(self, sample):
        found = self.decoder.decode(sample.payload.to_bytes())
        with self.condition:
            self.states.append(found)
            self.condition.notify()

    def wait_until(self, condition):
        with self.condition:
            assert self.condition.wait_for(condition, PATIENCE), (list(self.trips), list(self.states)[-1:])

    def rtt(self):
        """Median of the newest round trips (s) as its operator measured them."""
        return sorted(self.trips)[len(self.trips) // 2] if len(self.trips) == self.trips.maxlen else 0.0

    def wait_for_rtt(self, low, high):
        self.wait_until(lambda: low <= self.rtt() <= high)


@pytest.fixture
def started():
    programs = []

    def start(*arguments):
        programs.append(Program(*arguments))
        return programs[-1]

    yield start
    for program in programs:
        program.close()


def test_two_robots_and_two_operators_over_one_emulator(started, tmp_path, capsys):
    ports = iter(free_ports(5))
    operators, robots, control, *reports = (f"tcp/127.0.0.1:{port}" for port in ports)
    netem = started(
        "netem", "--network", "constant:10", "--robot-network", "b=constant:60",
        "--listen-operator", operators, "--listen-robot", robots, "--control", control,
    )  # fmt: skip
    looking = open_session([operators])
    seen = {}
    running = []
    for name, report in zip(TARGETS, reports, strict=True):
        scenario = tmp_path / f"{name}.toml"
        scenario.write_text(SCENARIO.format(target=TARGETS[name]))
        common = "--scenario", scenario, "--robot", name
        running.append(started("robot", *common, "--connect", robots))
        running.append(started("operator", *common, "--connect", operators, "--report", report))
        seen[name] = Observed(name, report, looking)
    a, b = seen["a"], seen["b"]
    try:
        # Each sees its own round trip, and each robot goes where its own operator wants it.
        a.wait_for_rtt(0.020, 0.080)
        b.wait_for_rtt(0.120, 0.180)
        a.wait_until(lambda: a.states and a.states[-1].position[0] > 0.2)
        b.wait_until(lambda: b.states and b.states[-1].position[1] > 0.2)
        assert abs(a.states[-1].position[1]) < 0.01
        assert abs(b.states[-1].position[0]) < 0.01
        holders = {name: {s.holder for s in each.states if s.mode == "run"} for name, each in seen.items()}
        assert [len(each) for each in holders.values()] == [1, 1]
        assert holders["a"].isdisjoint(holders["b"])
        assert not any(key.startswith("foreign") for each in seen.values() for key in each.states[-1].refused)

        capsys.readouterr()
        assert list_robots([operators], "", as_json=True) == 0
        listed = json.loads(capsys.readouterr().out)
        assert listed["netem"]
        assert [(row["robot"], row["there"], row["operator"]) for row in listed["robots"]] == [
            ("a", "yes", "yes"),
            ("b", "yes", "yes"),
        ]
        assert not {row["control"] for row in listed["robots"]} & {"free", "?"}

        # A live change is that robot's alone, and can be taken back.
        set_network("constant:110", "both", "b", control)
        assert capsys.readouterr().out.splitlines() == [
            "uplink: constant:10",
            "downlink: constant:10",
            "uplink of b: constant:110",
            "downlink of b: constant:110",
        ]
        b.wait_for_rtt(0.220, 0.300)
        a.wait_for_rtt(0.020, 0.080)
        shown = ask(control, {"do": "show"})["statistics"]
        assert shown["uplink"]["robot_specs"] == {"b": "constant:110"}
        assert shown["rtt_by_robot"]["a"]["p50"] < 0.08 < shown["rtt_by_robot"]["b"]["p50"]
        share("b", "both", control)
        b.wait_for_rtt(0.020, 0.080)
    finally:
        looking.close()
        for each in seen.values():
            each.session.close()
    for program in running:
        program.process.send_signal(signal.SIGINT)
    for program in running:
        program.process.wait(PATIENCE)
    assert netem.interrupt() == 0  # every message is accounted for
