"""The realtime executor on the system clock, and the small things of `common`."""

import threading

import numpy as np
import pytest

from farhand.common.errors import EndpointError, InputError
from farhand.common.geometry import distance, norm, to_vector3
from farhand.common.link.endpoints import check_endpoint, is_loopback
from farhand.common.link.link import MemoryLink, Packet, memory_wire
from farhand.common.messages.keys import (
    check_robot_name,
    command_key,
    description_key,
    kind_of,
    report_key,
    robot_of,
    scene_key,
    state_key,
)
from farhand.common.timing.clock import SystemClock
from farhand.common.timing.loop import RealtimeLoop
from farhand.common.timing.periodic import Periodic

MS = 1_000_000


class Counting:
    def __init__(self, steps, period):
        self.steps, self.period, self.times = steps, period, []
        self.executor = None

    def step(self, now_ns):
        self.times.append(now_ns)
        if len(self.times) == self.steps:
            self.executor.stop()
        return None if self.period is None else self.times[0] + len(self.times) * self.period


@pytest.mark.parametrize("message_driven", [False, True])
def test_deadlines_are_absolute_and_never_early(message_driven):
    node, clock = Counting(6, 5 * MS), SystemClock()
    node.executor = RealtimeLoop(node, clock, message_driven=message_driven, realtime=False)
    node.executor.run()
    assert len(node.times) == 6
    assert all(t >= node.times[0] + k * node.period for k, t in enumerate(node.times))
    assert node.executor.lateness.count == 6


def test_a_message_wakes_a_sleeping_node():
    node, clock = Counting(3, None), SystemClock()
    executor = node.executor = RealtimeLoop(node, clock, message_driven=True, realtime=False)
    thread = threading.Thread(target=executor.run)
    thread.start()
    while thread.is_alive():
        executor.notify()
        thread.join(0.001)
    assert len(node.times) == 3


def test_stop_ends_a_node_that_sleeps_for_ever():
    node = Counting(99, None)
    executor = RealtimeLoop(node, SystemClock(), realtime=False)
    thread = threading.Thread(target=executor.run)
    thread.start()
    executor.stop()
    thread.join(10)
    assert not thread.is_alive()


def test_exceptions_of_the_node_pass_through():
    class Broken:
        def step(self, now_ns):
            raise ArithmeticError("broken")

    with pytest.raises(ArithmeticError, match="broken"):
        RealtimeLoop(Broken(), SystemClock(), realtime=False).run()


def test_two_clocks_of_one_host_are_far_apart():
    assert abs(SystemClock().now_ns() - SystemClock().now_ns()) > MS


def test_missed_periods_are_overruns():
    periodic = Periodic(10)
    assert [periodic.due(t) for t in (100, 105, 110, 145, 150)] == [1, 0, 1, 3, 1]
    assert periodic.overruns == 2
    with pytest.raises(ValueError, match="positive"):
        Periodic(0)


def test_memory_wire_copies_and_stamps():
    left, right = memory_wire()
    packet = Packet("k", b"x", 5, envelope="e")
    left.send(packet)
    (got,) = right.receive()
    assert got == packet
    assert got is not packet
    assert left.receive() == []
    MemoryLink().send(packet)  # nobody at the other end


def test_keys():
    for kind, key in {
        "command": command_key,
        "state": state_key,
        "scene": scene_key,
        "description": description_key,
        "report": report_key,
    }.items():
        assert key("r-1") == f"farhand/r-1/{kind}"
        assert (robot_of(key("r-1")), kind_of(key("r-1"))) == ("r-1", kind)
    assert kind_of("farhand/r/camera/left") == "camera"
    assert robot_of("other/r/state") == kind_of("farhand/r") == ""
    assert check_robot_name("ur5.left_2-a") == "ur5.left_2-a"
    for bad in ("", "a/b", "a*", "a b", "é", "x" * 33, "a\n"):
        with pytest.raises(InputError, match="--robot"):
            check_robot_name(bad)


@pytest.mark.parametrize("good", ["tcp/127.0.0.1:7447", "tls/[::1]:1", "udp/robot.example:65535", "ws/a:80"])
def test_good_endpoints(good):
    assert check_endpoint(good) == good


@pytest.mark.parametrize(
    "bad",
    [
        "",
        "tcp",
        "127.0.0.1:7447",
        "tcp/:1",
        "tcp/h:0",
        "tcp/h:65536",
        "tcp/h:x",
        "tcp/h",
        "ftp/h:1",
        "tcp/h:1\n",
    ],
)
def test_bad_endpoints(bad):
    with pytest.raises(EndpointError, match="PROTOCOL/HOST:PORT"):
        check_endpoint(bad)


def test_loopback():
    assert all(map(is_loopback, ["tcp/127.0.0.1:1", "tcp/localhost:1", "tcp/[::1]:1"]))
    assert not any(map(is_loopback, ["tcp/10.0.0.1:1", "tcp/127.0.0.1.evil.example:1", "nonsense"]))


def test_geometry():
    assert to_vector3(np.array([1, 2, 3])) == (1.0, 2.0, 3.0)
    with pytest.raises(ValueError, match="unpack"):
        to_vector3([1, 2])
    assert norm([3, 4]) == 5
    assert distance((0, 0, 0), (0, 3, 4)) == 5


class Noting:
    """A node that reports, and notes in which order all is called."""

    def __init__(self, calls):
        self.calls, self.listeners = calls, []

    def step(self, now_ns):
        self.calls.append("step")
        for listener in self.listeners:
            listener("report")
        return now_ns + MS


def test_step_then_listeners_then_hooks_until_the_condition_holds():
    calls = []
    node = Noting(calls)
    node.listeners.append(calls.append)
    loop = RealtimeLoop(node, SystemClock(), realtime=False, until=lambda _: calls.count("after") == 2)
    loop.before.append(lambda _: calls.append("before"))
    loop.after.append(lambda _: calls.append("after"))
    loop.run()
    assert calls == ["before", "step", "report", "after"] * 2
    assert loop.ended_ns is not None


def test_a_condition_that_holds_at_the_start_lets_no_step_happen():
    calls = []
    RealtimeLoop(Noting(calls), SystemClock(), realtime=False, until=lambda _: True).run()
    assert calls == []


@pytest.mark.parametrize("message_driven", [False, True])
def test_a_condition_is_seen_while_the_node_sleeps(message_driven):
    node, over = Counting(99, None), threading.Event()
    loop = RealtimeLoop(
        node, SystemClock(), message_driven=message_driven, realtime=False, until=lambda _: over.is_set()
    )
    thread = threading.Thread(target=loop.run)
    thread.start()
    over.set()
    thread.join(10)
    assert not thread.is_alive()
    assert len(node.times) <= 1
