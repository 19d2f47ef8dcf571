"""The proxy over real Zenoh: everything passes with its metadata, and nothing passes by."""

import json
import os
import queue
import signal
import threading
import urllib.request

import pytest
import zenoh

from farhand.common.errors import EndpointError, InputError
from farhand.common.link.ports import free_ports
from farhand.common.link.zenoh_link import open_session
from farhand.common.timing.clock import SystemClock
from farhand.common.timing.loop import RealtimeLoop
from farhand.netem.check.check import CheckSettings, run_check, start_proxy, stop_proxy
from farhand.netem.control import ask
from farhand.netem.emulation import Emulation
from farhand.netem.netem_node import NetemNode
from farhand.netem.proxy import Meeting, Proxy
from farhand.netem.spec import parse_spec

pytestmark = pytest.mark.realtime
PATIENCE = 20.0
KEY = "farhand/r/command"


class Rig:
    """A proxy in this process, with an end on each side."""

    def __init__(self, spec="none"):
        self.notices = queue.Queue()
        ports = free_ports(2)
        self.endpoints = [f"tcp/127.0.0.1:{port}" for port in ports]
        clock = SystemClock()
        self.executor = None
        self.proxy = Proxy(*map(Meeting, self.endpoints), clock, self.wake, on_bypass=self.notices.put)
        links = self.proxy.operator_link, self.proxy.robot_link
        self.node = NetemNode(*links, Emulation(parse_spec(spec), parse_spec(spec), 1), instant=clock.now_ns)
        self.executor = RealtimeLoop(self.node, clock, message_driven=True, realtime=False)
        self.thread = threading.Thread(target=self.executor.run)
        self.thread.start()
        self.operator, self.robot = (open_session([endpoint]) for endpoint in self.endpoints)

    def wake(self):
        if self.executor is not None:
            self.executor.notify()

    def meet(self):
        """Wait until a message gets through, both ways."""
        for sender, receiver in ((self.operator, self.robot), (self.robot, self.operator)):
            arrived = threading.Event()
            subscriber = receiver.declare_subscriber("hello", lambda _, event=arrived: event.set())
            for _ in range(200):
                sender.put("hello", b"")
                if arrived.wait(0.1):
                    break
            assert arrived.is_set()
            subscriber.undeclare()

    def close(self):
        self.executor.stop()
        self.thread.join()
        self.operator.close()
        self.robot.close()
        self.proxy.close()


@pytest.fixture
def rig():
    rig = Rig("constant:5")
    yield rig
    rig.close()
    rig.node.check_conservation()


def subscribe(session, key):
    samples = queue.Queue()
    session.declare_subscriber(key, samples.put)
    return samples


def test_metadata_is_copied(rig):
    samples = subscribe(rig.robot, KEY)
    rig.meet()
    publisher = rig.operator.declare_publisher("other")
    stamp = rig.operator.new_timestamp()
    rig.operator.put(
        KEY,
        b"hello",
        encoding=zenoh.Encoding.APPLICATION_JSON,
        priority=zenoh.Priority.REAL_TIME,
        congestion_control=zenoh.CongestionControl.BLOCK,
        express=True,
        attachment=b"attached",
        timestamp=stamp,
        source_info=zenoh.SourceInfo(publisher.id, 77),
    )
    rig.operator.delete(KEY, attachment=b"gone", priority=zenoh.Priority.BACKGROUND)
    put, deleted = samples.get(timeout=PATIENCE), samples.get(timeout=PATIENCE)
    assert put.kind == zenoh.SampleKind.PUT
    assert put.payload.to_bytes() == b"hello"
    assert put.encoding == zenoh.Encoding.APPLICATION_JSON
    assert put.priority == zenoh.Priority.REAL_TIME
    assert put.congestion_control == zenoh.CongestionControl.BLOCK
    assert put.express
    assert put.attachment.to_bytes() == b"attached"
    assert put.timestamp == stamp
    assert put.source_info.source_sn == 77
    assert str(put.source_info.source_id.zid) == str(rig.operator.zid())
    assert deleted.kind == zenoh.SampleKind.DELETE
    assert deleted.attachment.to_bytes() == b"gone"
    assert deleted.priority == zenoh.Priority.BACKGROUND


def test_nothing_is_echoed_and_reports_stay_on_their_side(rig):
    own = queue.Queue()
    rig.operator.declare_subscriber("**", own.put, allowed_origin=zenoh.Locality.REMOTE)
    other = subscribe(rig.robot, "farhand/**")
    rig.meet()
    rig.operator.put("farhand/r/report", b"private")
    rig.operator.put(KEY, b"last")
    assert other.get(timeout=PATIENCE).payload.to_bytes() == b"last"
    assert rig.proxy.statistics()["local"] == 1
    rig.robot.put("farhand/r/state", b"back")
    keys = [str(own.get(timeout=PATIENCE).key_expr)]
    while keys[-1] != "farhand/r/state":
        keys.append(str(own.get(timeout=PATIENCE).key_expr))
    assert set(keys) <= {"hello", "farhand/r/state"}


def test_queries_and_their_replies_pass(rig):
    def answer(query):
        with query:
            if query.parameters.get("fail"):
                query.reply_err(b"no")
            else:
                query.reply("asked/it", query.payload.to_bytes() * 2, attachment=query.attachment)

    rig.robot.declare_queryable("asked/*", answer)
    rig.meet()
    replies = list(rig.operator.get("asked/it", payload=b"ab", attachment=b"with", timeout=PATIENCE))
    assert [r.ok.payload.to_bytes() for r in replies] == [b"abab"]
    assert replies[0].ok.attachment.to_bytes() == b"with"
    errors = list(rig.operator.get("asked/it?fail=1", payload=b"", timeout=PATIENCE))
    assert [r.err.payload.to_bytes() for r in errors] == [b"no"]
    assert list(rig.operator.get("nobody/home", timeout=PATIENCE)) == []


def test_liveliness_passes_both_ways(rig):
    changes = queue.Queue()
    rig.operator.liveliness().declare_subscriber("alive/**", changes.put, history=True)
    rig.meet()
    token = rig.robot.liveliness().declare_token("alive/r")
    change = changes.get(timeout=PATIENCE)
    assert (str(change.key_expr), change.kind) == ("alive/r", zenoh.SampleKind.PUT)
    assert [str(r.ok.key_expr) for r in rig.operator.liveliness().get("alive/**")] == ["alive/r"]
    token.undeclare()
    change = changes.get(timeout=PATIENCE)
    assert (str(change.key_expr), change.kind) == ("alive/r", zenoh.SampleKind.DELETE)
    assert list(rig.operator.liveliness().get("alive/**")) == []


def test_who_is_on_both_sides_is_noticed(rig):
    both = open_session(rig.endpoints)
    try:
        assert str(both.zid()) in rig.notices.get(timeout=PATIENCE)
        assert rig.proxy.statistics()["both_sides"] == [str(both.zid())]
    finally:
        both.close()


def test_a_taken_port_is_one_line(rig):
    with pytest.raises(EndpointError, match="already in use"):
        Proxy(*map(Meeting, rig.endpoints), SystemClock(), lambda: None)


def test_check_of_the_real_proxy():
    found = run_check(
        CheckSettings(
            uplink="gaussian:20,8 loss:gilbert(5%,30%) duplicate:5%",
            downlink="rate:1mbit uniform:1,9 outage:every(500ms,100ms,hold) reorder:in-order",
            rate_hz=200,
            seconds=1.5,
        )
    )
    assert found["passed"]
    assert found["uplink"]["sent"] == 300
    assert found["uplink"]["lost_as_drawn"]["loss"] > 0
    assert found["uplink"]["reordered_as_drawn"] > 0
    assert found["downlink"]["reordered_on_arrival"] == 0
    assert found["downlink"]["delivered"] == 300


@pytest.fixture
def program(tmp_path):
    """A proxy process with live control and metrics."""
    ports = free_ports(4)
    settings = {
        "listen_operator": f"tcp/127.0.0.1:{ports[0]}",
        "listen_robot": f"tcp/127.0.0.1:{ports[1]}",
        "control": str(ports[2]),
        "metrics": ports[3],
        "stats": str(tmp_path / "stats.json"),
        "uplink": "gaussian:5,1",
    }
    process = start_proxy(settings)
    try:
        yield process, settings
    finally:
        if process.poll() is None:
            stop_proxy(process)


def test_live_control_and_metrics_of_a_running_program(program):
    process, settings = program
    assert ask(settings["control"], {"do": "show"})["statistics"]["uplink"]["spec"] == "gaussian:5,1"
    found = ask(settings["control"], {"do": "add", "direction": "downlink", "spec": "loss:1%"})
    assert found["specs"] == {"uplink": "gaussian:5,1", "downlink": "loss:1%"}
    with pytest.raises(InputError, match="above 1"):
        ask(settings["control"], {"do": "add", "spec": "loss:200%"})
    operator, robot = open_session([settings["listen_operator"]]), open_session([settings["listen_robot"]])
    try:
        samples = subscribe(robot, KEY)
        for _ in range(200):
            operator.put(KEY, b"x")
            try:
                samples.get(timeout=0.1)
                break
            except queue.Empty:
                continue
        with urllib.request.urlopen(f"http://127.0.0.1:{settings['metrics']}/metrics") as reply:
            text = reply.read().decode()
    finally:
        operator.close()
        robot.close()
    assert 'farhand_netem_delivered_total{direction="uplink",robot="r"}' in text
    os.kill(process.pid, signal.SIGINT)
    process.communicate(timeout=PATIENCE)
    assert process.returncode == 0
    with open(settings["stats"], encoding="utf-8") as file:
        statistics = json.load(file)
    assert statistics["conserved"]
    assert statistics["downlink"]["spec"] == "loss:1%"


def test_both_sides_come_back_after_the_proxy_was_killed(program):
    process, settings = program
    operator, robot = open_session([settings["listen_operator"]]), open_session([settings["listen_robot"]])
    restarted = None
    try:
        samples = subscribe(robot, KEY)

        def reach(payload):
            for _ in range(200):
                operator.put(KEY, payload)
                try:
                    while samples.get(timeout=0.1).payload.to_bytes() != payload:
                        pass
                    return True
                except queue.Empty:
                    continue
            return False

        assert reach(b"before")
        process.kill()
        process.communicate()
        restarted = start_proxy(settings)
        assert reach(b"after")
    finally:
        operator.close()
        robot.close()
        if restarted is not None:
            stop_proxy(restarted)


def test_a_program_with_a_taken_port_says_so(program):
    _, settings = program
    with pytest.raises(EndpointError, match="already in use"):
        start_proxy({"listen_operator": settings["listen_operator"], "listen_robot": "tcp/127.0.0.1:1"})
