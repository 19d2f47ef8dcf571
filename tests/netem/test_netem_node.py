"""The emulator node over in-memory links, in virtual time."""

import json

import msgspec
import pytest

from farhand.common.errors import InputError
from farhand.common.link.link import Packet
from farhand.common.messages.base import Echo
from farhand.common.messages.codec import encode
from farhand.laboratory.virtual_executor import Priority, VirtualExecutor
from farhand.netem.action import Action
from farhand.netem.control import handle
from farhand.netem.emulation import Emulation
from farhand.netem.envelope import MustArrive
from farhand.netem.netem_node import ConservationError, NetemNode
from farhand.netem.release_queue import Limits
from farhand.netem.spec import parse_spec
from farhand.netem.timeline import load_timeline
from farhand.testing import command, state

MS = 1_000_000
SECOND = 1_000_000_000


class Rig:
    """An emulator between two ends, in virtual time."""

    def __init__(self, uplink, downlink=None, limits=Limits(), **kwargs):  # noqa: B008
        self.executor = VirtualExecutor(1000)
        self.operator, near = self.executor.wire()
        far, self.robot = self.executor.wire()
        specs = parse_spec(uplink), parse_spec(downlink or uplink)
        self.node = NetemNode(near, far, Emulation(*specs, 1, limits=limits), **kwargs)
        self.executor.add(self.node, Priority.NETEM)
        self.executor.wake_on_message(self.node, near)
        self.executor.wake_on_message(self.node, far)

    def at(self, time_ms, call):
        self.executor.call_at(1000 + round(time_ms * MS), Priority.OPERATOR, lambda _: call())

    def send(self, time_ms, end, key, payload=b"x", envelope=None):
        link = getattr(self, end)
        self.at(time_ms, lambda: link.send(Packet(key, payload, envelope=envelope)))

    def run(self, time_ms):
        self.executor.run_until(1000 + round(time_ms * MS))
        self.node.check_conservation()
        return msgspec.to_builtins(self.node.statistics())


def received(link):
    return [(round((p.arrived_ns - 1000) / MS, 6), p.payload) for p in link.receive()]


def test_both_ways_with_their_own_delay():
    rig = Rig("constant:20", "constant:30")
    rig.send(0, "operator", "farhand/r/command", b"up")
    rig.send(5, "robot", "farhand/r/state", b"down")
    rig.run(100)
    assert received(rig.robot) == [(20, b"up")]
    assert received(rig.operator) == [(35, b"down")]


def test_statistics_account_for_everything_and_are_json():
    rig = Rig("gaussian:50,20 loss:10% duplicate:10% corrupt:10% rate:200kbit,2kB")
    for n in range(2000):
        rig.send(n * 2, "operator", f"farhand/r{n % 3}/command", bytes(100))
    found = rig.run(3000)
    json.dumps(found)
    up = found["uplink"]
    assert up["received"] + up["duplicated"] == up["delivered"] + sum(up["dropped"].values()) + up["queued"]
    assert up["queued"] > 0
    assert set(up["dropped"]) == {"loss", "queue"}
    assert sum(r["received"] for r in up["robots"].values()) == up["received"]
    assert up["error"]["max"] == 0.0
    assert found["downlink"]["received"] == 0


def test_a_vanished_message_is_said_loudly():
    rig = Rig("constant:20")
    rig.send(0, "operator", "farhand/r/command")
    rig.run(5)
    rig.node.directions["uplink"].queue._heap.clear()
    with pytest.raises(ConservationError, match="cannot account"):
        rig.node.check_conservation()


def test_memory_is_bounded_in_an_hour_of_outage():
    rig = Rig("outage:at(0s,3600s,hold)", limits=Limits(messages=100, size=5000))
    for n in range(1000):
        rig.send(n, "operator", "farhand/r/command", bytes(100))
        rig.send(n, "robot", "farhand/r/state", b"")
    found = rig.run(1100)
    assert found["uplink"]["queued"] == 50
    assert found["uplink"]["dropped"] == {"memory": 950}
    assert found["downlink"]["queued"] == 100
    assert found["downlink"]["dropped"] == {"memory": 900}
    assert rig.run(3_700_000)["uplink"]["delivered"] == 50


def test_malformed_payloads_pass_through():
    rig = Rig("none")
    junk = [b"", b"\xc1", bytes(range(256)), b"\x81" * 40]
    for n, payload in enumerate(junk):
        rig.send(n, "operator", "farhand/r/command", payload)
        rig.send(n, "robot", "farhand/r/state", payload)
    rig.run(100)
    assert [p for _, p in received(rig.robot)] == junk
    assert [p for _, p in received(rig.operator)] == junk


def test_round_trip_from_echoes():
    """20 ms up, held 7 ms, 30 ms down: 50 ms of network."""
    rig = Rig("constant:20", "constant:30")
    rig.send(0, "operator", "farhand/r/command", encode(command(0)))
    rig.send(27, "robot", "farhand/r/state", encode(state(0, echo=Echo(7, 0, 5, 7 * MS))))
    found = rig.run(100)
    assert found["rtt_by_robot"]["r"]["count"] == 1
    assert found["rtt"]["mean"] == pytest.approx(0.05)
    assert found["bypassed"] == 0


def test_an_echo_of_what_was_not_let_through_is_a_bypass():
    rig = Rig("loss:100%", "none")
    rig.send(0, "operator", "farhand/r/command", encode(command(0)))
    rig.send(1, "robot", "farhand/r/state", encode(state(0, echo=Echo(7, 0, 5, 0))))
    rig.send(2, "robot", "farhand/r/state", encode(state(1, echo=Echo(7, 9, 5, 0))))
    rig.send(3, "robot", "farhand/r/state", encode(state(2, echo=Echo(8, 9, 5, 0))))
    assert rig.run(100)["bypassed"] == 2


def test_what_must_arrive_is_sent_again():
    rig = Rig("outage:at(0s,1s)")
    rig.send(0, "operator", "token", b"", MustArrive())
    found = rig.run(5000)
    assert received(rig.robot) == [(1000, b"")]
    assert found["uplink"]["retransmitted"] == 5


def fates(packets, spec):
    rig = Rig(spec)
    for time_ms, end, key in packets:
        rig.send(time_ms, end, key, b"%f" % time_ms)
    rig.run(20_000)
    return received(rig.robot), received(rig.operator)


def test_same_seed_same_run():
    packets = [(n * 3, ("operator", "robot")[n % 2], f"farhand/r/{n % 5}") for n in range(500)]
    spec = "gaussian:50,20,20% loss:gilbert(3%,30%) duplicate:3% slot:7,11 outage:random(500ms,50ms)"
    assert fates(packets, spec) == fates(packets, spec)


TIMELINE = """
[[at]]
time = 0.1
do = "set"
direction = "uplink"
spec = "constant:50"

[[at]]
time = 0.2
do = "outage"
length = 0.1

[[at]]
time = 0.4
do = "reset"
"""


def test_timeline_runs_in_virtual_time(tmp_path):
    file = tmp_path / "timeline.toml"
    file.write_text(TIMELINE)
    rig = Rig("none", schedule=load_timeline(file))
    for n in range(0, 1000, 50):
        rig.send(2000 + n + 1, "operator", "k", b"%d" % n)
    rig.run(5000)
    found = {int(p): round(t - 2001 - int(p)) for t, p in received(rig.robot)}
    assert [n for n in range(0, 1000, 50) if n not in found] == [200, 250]
    assert {n for n, delay in found.items() if delay == 50} == {100, 150, 300, 350}
    assert set(found.values()) == {0, 50}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            "[[at]]\ntime = 2.0\ndo = 'reset'\n[[at]]\ntime = 1.0\ndo = 'reset'",
            "step 2: time 1.0 s comes before",
        ),
        ("[[at]]\ntime = -1.0\ndo = 'reset'", "lies outside"),
        ("[[at]]\ntime = nan\ndo = 'reset'", "lies outside"),
        ("[[at]]\ntime = 1.0\ndo = 'set'\nspec = 'loss:2'", "step 1: network"),
        ("[[at]]\ntime = 1.0\ndo = 'set'\nspec = 'none'\ndirection = 'sideways'", "sideways"),
        ("[[at]]\ntime = 1.0\ndo = 'outage'", "above 0"),
        ("[[at]]\ntime = 1.0\ndo = 'jump'", "jump"),
        ("[[at]]\ntime = 1.0\ndo = 'reset'\nspeed = 3", "speed"),
        ("[[at", "not valid TOML"),
        ("at = 3", "array"),
    ],
)
def test_a_bad_timeline_is_one_line(tmp_path, text, words):
    path = tmp_path / "x.toml"
    path.write_text(text)
    with pytest.raises(InputError) as found:
        load_timeline(path)
    assert words in str(found.value)
    assert "\n" not in str(found.value)


def ask(rig, request):
    payload = request if isinstance(request, bytes) else json.dumps(request).encode()
    return json.loads(handle(rig.node, payload, rig.executor.clock.now_ns()))


def specs(rig):
    return {name: str(d.chain.spec) for name, d in rig.node.directions.items()}


def test_live_control_changes_what_it_is_asked_to():
    rig = Rig("gaussian:50,20", "none")
    assert ask(rig, {"do": "show"})["statistics"]["uplink"]["spec"] == "gaussian:50,20"
    ask(rig, {"do": "add", "spec": "loss:1%"})
    assert specs(rig) == {"uplink": "loss:1% gaussian:50,20", "downlink": "loss:1%"}
    ask(rig, {"do": "remove", "name": "delay"})  # from the direction that has one
    assert specs(rig) == {"uplink": "loss:1%", "downlink": "loss:1%"}
    ask(rig, {"do": "set", "spec": "constant:5", "direction": "downlink"})
    assert specs(rig) == {"uplink": "loss:1%", "downlink": "constant:5"}
    assert ask(rig, {"do": "reset"})["specs"] == {"uplink": "gaussian:50,20", "downlink": "none"}
    assert rig.node.statistics().changes == 4
    assert ask(rig, {"do": "show"})["outage_left"] == 0.0
    ask(rig, {"do": "outage", "length": 2.0, "direction": "downlink"})
    assert ask(rig, {"do": "show"})["outage_left"] == 2.0


@pytest.mark.parametrize(
    "request_",
    [
        b"",
        b"\xff\xfe",
        b"[" * 100_000,
        {"do": "set", "spec": "loss:2"},
        {"do": "set", "spec": "trace:/nowhere.csv"},
        {"do": "set"},
        {"do": "set", "spec": "none", "direction": "sideways"},
        {"do": "add", "spec": "none", "speed": 1},
        {"do": "remove", "name": "loss"},
        {"do": "remove", "name": "wings"},
        {"do": "outage", "length": -1},
        {"do": "outage", "length": 1e300},
        {"do": "fly"},
        [],
    ],
)
def test_a_malformed_request_changes_nothing(request_):
    rig = Rig("gaussian:50,20 duplicate:1%")
    reply = ask(rig, request_)
    assert reply["ok"] is False
    assert reply["error"]
    assert specs(rig) == {"uplink": "duplicate:1% gaussian:50,20", "downlink": "duplicate:1% gaussian:50,20"}


def test_remove_takes_what_is_there_and_refuses_where_nothing_is():
    rig = Rig("loss:1%", "none")
    with pytest.raises(InputError, match="the downlink has no 'loss'"):
        Action(do="remove", name="loss", direction="downlink").perform(rig.node, 0)
    assert specs(rig)["uplink"] == "loss:1%"
    Action(do="remove", name="loss").perform(rig.node, 0)
    assert specs(rig) == {"uplink": "none", "downlink": "none"}
    with pytest.raises(InputError, match="the uplink has no 'loss'"):
        Action(do="remove", name="loss").perform(rig.node, 0)
