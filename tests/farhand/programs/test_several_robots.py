"""The real programs: two robots and two operators over one emulator, each with a network of its own."""

import json
import signal

import pytest

from farhand.commands.emulation.netem_live import common as share
from farhand.commands.emulation.netem_live import set_network
from farhand.common.link.ports import free_ports
from farhand.netem.control import ask
from farhand.programs.command_line import NetemWords, OperatorWords, RobotWords
from farhand.site.robots import list_robots
from farhand.testing import Witness, short_task

pytestmark = pytest.mark.realtime
TARGETS = {"a": [30.0, 0.0, 0.5], "b": [0.0, 30.0, 0.5]}
"""So far away that nobody arrives, and each robot in a direction of its own."""


class Observed(Witness):
    """What is seen of one robot from outside, and the round trips that its operator measures."""

    def rtt(self):
        """Median of the newest twenty (s)."""
        trips = sorted([report.rtt for report in self.reports if report.rtt is not None][-20:])
        return trips[10] if len(trips) == 20 else 0.0

    def wait_for_rtt(self, low, high):
        self.wait_for(lambda: low <= self.rtt() <= high)


def test_two_robots_and_two_operators_over_one_emulator(started, tmp_path, capsys):
    ports = iter(free_ports(5))
    operators, robots, control, *reports = (f"tcp/127.0.0.1:{port}" for port in ports)
    netem = started(
        NetemWords(
            network="constant:10",
            robot_network=("b=constant:60",),
            listen_operator=operators,
            listen_robot=robots,
            control=control,
        )
    )
    seen = {}
    running = []
    for name, report in zip(TARGETS, reports, strict=True):
        folder = tmp_path / name
        folder.mkdir()
        task = {"scenario": str(short_task(folder, targets=[TARGETS[name]])), "robot": name}
        running.append(started(RobotWords(**task, connect=(robots,))))
        running.append(started(OperatorWords(**task, connect=(operators,), report=report)))
        seen[name] = Observed(operators, name, report)
    a, b = seen["a"], seen["b"]
    try:
        # Each sees its own round trip, and each robot goes where its own operator wants it.
        a.wait_for_rtt(0.020, 0.080)
        b.wait_for_rtt(0.120, 0.180)
        a.wait_until(lambda s: s.position[0] > 0.2)
        b.wait_until(lambda s: s.position[1] > 0.2)
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
        for each in seen.values():
            each.close()
    for program in running:
        program.signal(signal.SIGINT)
    for program in running:
        program.wait()
    assert netem.interrupt() == 0  # every message is accounted for
