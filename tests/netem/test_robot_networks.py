"""Each robot its own network over one emulator, from the start or by live control, in virtual time."""

import io
import json
from typing import get_args

import msgspec
import pytest
from rich.console import Console

from farhand.commands.emulation.netem_options import own_networks
from farhand.common.errors import InputError
from farhand.common.link.link import Packet, memory_wire
from farhand.netem.action import Action
from farhand.netem.control import handle
from farhand.netem.emulation import Emulation
from farhand.netem.measure.report import print_statistics
from farhand.netem.measure.round_trips import MAX_ROBOTS
from farhand.netem.netem_node import NetemNode
from farhand.netem.settings import NetemSettings
from farhand.netem.spec import parse_spec
from farhand.netem.timeline import load_timeline

MS = 1_000_000
ROBOTS = ("arm1", "arm2", "arm3")


class Rig:
    """An emulator between two in-memory ends, at a time that the test sets."""

    def __init__(self, network="none", own=None, **kwargs):
        self.operator, operator_end = memory_wire()
        self.robot, robot_end = memory_wire()
        spec = parse_spec(network)
        own = {
            name: {way: parse_spec(text) for way, text in ways.items()} for name, ways in (own or {}).items()
        }
        self.node = NetemNode(operator_end, robot_end, Emulation(spec, spec, 1, own), **kwargs)
        self.now_ns = 1

    def ask(self, do, **fields):
        reply = handle(self.node, msgspec.json.encode({"do": do, **fields}), self.now_ns)
        return msgspec.json.decode(reply)

    def send(self, *robots):
        for name in robots:
            self.operator.send(Packet(f"farhand/{name}/command", b"x", self.now_ns))
        self.node.step(self.now_ns)

    def delays(self, *robots, wait_ms=10_000):
        """What a command to each robot is delayed by (ms), in order of arrival; then `wait_ms` have passed."""
        sent_ns = self.now_ns
        self.send(*robots)
        found = {p.key.split("/")[1]: 0.0 for p in self.robot.receive()}
        end_ns = sent_ns + wait_ms * MS
        while (next_ns := self.node.step(self.now_ns)) is not None and next_ns <= end_ns:
            self.now_ns = next_ns
            self.node.step(next_ns)
            for packet in self.robot.receive():
                found[packet.key.split("/")[1]] = (next_ns - sent_ns) / MS
        self.now_ns = end_ns
        self.node.check_conservation()
        return found


def test_networks_of_their_own_from_the_start():
    rig = Rig(own={"arm2": {"uplink": "constant:100"}, "arm3": {"uplink": "loss:100%", "downlink": "none"}})
    assert rig.delays(*ROBOTS) == {"arm1": 0, "arm2": 100}
    found = msgspec.to_builtins(rig.node.statistics())
    assert found["uplink"]["robot_specs"] == {"arm2": "constant:100", "arm3": "loss:100%"}
    assert found["downlink"]["robot_specs"] == {"arm3": "none"}


def test_a_live_change_is_one_robots_alone_and_can_be_taken_back():
    rig = Rig("constant:10")
    found = rig.ask("set", spec="constant:50", robot="arm2")
    assert found["robot_specs"] == {"uplink": {"arm2": "constant:50"}, "downlink": {"arm2": "constant:50"}}
    assert found["specs"] == {"uplink": "constant:10", "downlink": "constant:10"}
    assert rig.delays(*ROBOTS) == {"arm1": 10, "arm2": 50, "arm3": 10}
    rig.ask("set", spec="constant:20")  # the common network: not that of arm2
    assert rig.delays("arm1", "arm2") == {"arm1": 20, "arm2": 50}
    rig.ask("set", spec="constant:70", robot="arm2", direction="downlink")
    assert rig.delays("arm2") == {"arm2": 50}
    assert rig.ask("common", robot="arm2")["robot_specs"] == {"uplink": {}, "downlink": {}}
    assert rig.delays("arm1", "arm2") == {"arm1": 20, "arm2": 20}


def test_add_and_remove_begin_with_a_copy_of_the_common_network():
    rig = Rig("constant:10")
    assert rig.ask("add", spec="loss:100%", robot="arm2", direction="uplink")["robot_specs"]["uplink"] == {
        "arm2": "loss:100% constant:10"
    }
    assert rig.delays("arm1", "arm2") == {"arm1": 10}
    rig.ask("remove", name="loss", robot="arm2", direction="uplink")
    assert rig.delays("arm1", "arm2") == {"arm1": 10, "arm2": 10}
    refused = rig.ask("remove", name="loss", robot="arm2", direction="uplink")["error"]
    assert "of robot 'arm2' has no 'loss'" in refused


def test_an_outage_for_one_and_an_outage_for_all():
    rig = Rig("none", {"arm2": {"uplink": "constant:5"}})
    rig.ask("outage", length=1.0, robot="arm1")
    assert rig.delays(*ROBOTS, wait_ms=2000) == {"arm2": 5, "arm3": 0}
    assert rig.delays(*ROBOTS, wait_ms=2000) == {"arm1": 0, "arm2": 5, "arm3": 0}
    rig.ask("outage", length=1.0)
    rig.ask("set", spec="constant:1", robot="arm3")  # no way out of the outage that is for all
    assert rig.delays(*ROBOTS, wait_ms=2000) == {}
    assert rig.delays(*ROBOTS) == {"arm1": 0, "arm2": 5, "arm3": 1}


def test_what_is_queued_keeps_its_fate_when_the_network_changes():
    rig = Rig("constant:100", {"arm2": {"uplink": "constant:200"}})
    rig.send("arm1", "arm2")
    rig.ask("common", robot="arm2")
    rig.ask("set", spec="none", robot="arm1")
    assert rig.delays(wait_ms=1000) == {"arm1": 100, "arm2": 200}


def test_reset_goes_back_to_the_start():
    rig = Rig("constant:10", {"arm2": {"uplink": "constant:20"}})
    rig.ask("set", spec="constant:50", robot="arm1")
    rig.ask("common", robot="arm2")
    assert rig.delays(*ROBOTS) == {"arm1": 50, "arm2": 10, "arm3": 10}
    rig.ask("reset", robot="arm2")
    assert rig.delays(*ROBOTS) == {"arm1": 50, "arm2": 20, "arm3": 10}
    rig.ask("reset")
    assert rig.delays(*ROBOTS) == {"arm1": 10, "arm2": 20, "arm3": 10}
    assert "no network of its own" in rig.ask("reset", robot="arm9")["error"]


@pytest.mark.parametrize(
    "request_",
    [{"do": "common"}, {"do": "common", "robot": "arm1"}, {"do": "set", "spec": "none", "robot": "a/b"}],
)
def test_what_makes_no_sense_changes_nothing(request_):
    rig = Rig("constant:10")
    reply = rig.ask(**request_)
    assert not reply["ok"]
    assert "\n" not in reply["error"]
    assert rig.node.statistics().uplink.robot_specs == {}


def fates(network, robots=ROBOTS, own=True, seed=1):
    """Which of 400 commands of each robot arrive, and when."""
    operator, operator_end = memory_wire()
    robot, robot_end = memory_wire()
    spec = parse_spec(network)
    networks = {name: {"uplink": spec} for name in robots} if own else {}
    node = NetemNode(operator_end, robot_end, Emulation(spec, spec, seed, networks))
    found = {name: [] for name in robots}
    for tick in range(40_000):
        now_ns = 1 + tick * MS
        if tick % 10 == 0 and tick < 4000:
            for name in robots:
                operator.send(Packet(f"farhand/{name}/command", b"x" * 50, now_ns))
        node.step(now_ns)
        for packet in robot.receive():
            found[packet.key.split("/")[1]].append(tick)
        if tick >= 4000 and not len(node.directions["uplink"].queue):
            break
    node.check_conservation()
    return found


@pytest.mark.parametrize(
    "network", ["gaussian:50,20 loss:5%", "outage:random(200,100)", "slot:5,40", "5g-rural"]
)
def test_robots_of_the_same_spec_and_seed_draw_apart_and_repeatably(network):
    """Streams of whole links, such as random outages, too: not the same draws under two names."""
    first = fates(network)
    assert first["arm1"] != first["arm2"] != first["arm3"] != first["arm1"]
    assert first == fates(network)
    assert first["arm2"] == fates(network, ("arm2",))["arm2"]


def test_the_same_network_given_again_begins_new_streams():
    rig = Rig("none")
    drawn = []
    for _ in range(3):
        rig.ask("set", spec="gaussian:50,20", robot="arm1")
        drawn.append(tuple(rig.delays("arm1")["arm1"] for _ in range(3)))
        rig.ask("common", robot="arm1")
    assert len(set(drawn)) == 3


def test_a_timeline_changes_one_robot(tmp_path):
    path = tmp_path / "timeline.toml"
    path.write_text(
        '[[at]]\ntime = 1.0\ndo = "set"\nspec = "constant:30"\nrobot = "arm2"\n'
        '[[at]]\ntime = 2.0\ndo = "common"\nrobot = "arm2"\n'
    )
    rig = Rig("constant:10", schedule=load_timeline(path))
    seen = [rig.delays("arm1", "arm2", wait_ms=1000) for _ in range(3)]
    assert [s["arm2"] for s in seen] == [10, 30, 10]
    assert {s["arm1"] for s in seen} == {10}
    path.write_text('[[at]]\ntime = 1.0\ndo = "common"\n')
    with pytest.raises(InputError, match="step 1: common: say which robot"):
        load_timeline(path)


def test_the_option_takes_uplink_and_downlink_apart():
    given = own_networks(["a:uplink=loss:1%", "a=constant:5", "b:downlink=none"])
    networks = NetemSettings(robot_networks=given).own_networks()
    assert {n: {w: str(s) for w, s in ways.items()} for n, ways in networks.items()} == {
        "a": {"uplink": "loss:1%", "downlink": "constant:5"},
        "b": {"downlink": "none"},
    }
    for text, wrong in (
        ("a", "expected NAME=SPEC"),
        ("a:up=none", "NAME:uplink=SPEC"),
        ("a/b=none", "a robot's name"),
        ("a=nonsense", "no impairment"),
        ("=none", "a robot's name"),
    ):
        with pytest.raises(InputError, match=wrong) as refused:
            own_networks([text])
        assert "\n" not in str(refused.value)
    with pytest.raises(InputError, match="twice"):
        own_networks(["a=none", "a=constant:5"])


def test_statistics_and_actions_are_json():
    rig = Rig("gaussian:1,5", {"arm2": {"uplink": "gaussian:1,5"}})
    for _ in range(30):
        rig.delays("arm2", wait_ms=50)
    found = json.loads(msgspec.json.encode(rig.node.statistics()))
    assert found["uplink"]["below_zero"] > 0  # of a network of its own, too
    rig.ask("common", robot="arm2")
    assert rig.node.statistics().uplink.below_zero == found["uplink"]["below_zero"]
    assert "common" in get_args(Action.__annotations__["do"])


def test_the_table_shows_each_robots_network_and_numbers():
    rig = Rig("constant:10", {"arm2": {"uplink": "constant:100"}})
    rig.delays("arm1", "arm2")
    console = Console(width=80, file=io.StringIO())
    print_statistics(rig.node.statistics(), console)
    rows = console.file.getvalue().splitlines()
    assert any("arm1" in row and "100.0" not in row for row in rows)
    assert any("arm2" in row and "100.0 / 100.0" in row for row in rows)
    assert max(map(len, rows)) <= 80
    alone = Rig("constant:10")
    alone.delays("arm1")
    console = Console(width=80, file=io.StringIO())
    print_statistics(alone.node.statistics(), console)
    assert "arm1" not in console.file.getvalue()


def test_networks_of_robots_are_bounded():
    rig = Rig()
    for number in range(MAX_ROBOTS):
        assert rig.ask("set", spec="none", robot=f"r{number}")["ok"]
    assert "robots have had a network" in rig.ask("set", spec="none", robot="more")["error"]
