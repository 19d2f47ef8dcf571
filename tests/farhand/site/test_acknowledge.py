"""`farhand acknowledge`: by the operator in control, or straight where nobody is; it drives nothing."""

from types import SimpleNamespace

import pytest

from farhand.common.link.ports import free_ports
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.command import VelocityCommand
from farhand.operator_side.steering.device import SteeringInput
from farhand.operator_side.supervision import Supervision
from farhand.robot_side.safety.settings import SafetySettings
from farhand.robot_side.safety.watchdog import Watchdog
from farhand.site.acknowledge import AcknowledgeServer, acknowledge
from farhand.site.clearing import Clearing, why_not
from farhand.site.estop import emergency_stop
from farhand.testing import Programs, Witness, short_task, state
from tests.farhand.site.fakes import Asked, Direct, Silent

FAR = [(50.0, 0.0, 0.5)]
DRIVE = SteeringInput((0.1, 0.0, 0.0), engaged=True)
SECOND = 1_000_000_000


def stopped(seq=0, mode="estop", reason="emergency stop by bob", **fields):
    return state(seq, mode=mode, reason=reason, **fields)


@pytest.mark.parametrize(
    ("shown", "why"),
    [
        (None, "nothing has come"),
        (state(mode="run", reason="commanded"), "nothing to acknowledge: robot 'r' is in run (commanded)"),
        (stopped(holder=0), "does not hold control; nobody does"),
        (stopped(holder=8, holder_name="bob"), "does not hold control; bob does"),
        (stopped(), ""),
        (stopped(mode="stopped"), ""),
    ],
)
def test_what_cannot_be_acknowledged_is_refused_with_the_reason(shown, why):
    assert why in why_not(shown, 7)
    assert bool(why) == bool(why_not(shown, 7))


def test_the_operator_acknowledges_the_stop_that_it_was_asked_about_and_no_other():
    ours = Supervision(7, "operator")
    ours.clear(stopped(1, stops=1))
    told = ours.step(stopped(2, stops=1), "", DRIVE, 0)
    assert told.mode == "acknowledge"
    assert ours.step(state(3, mode="hold", stops=1), "", DRIVE, 0).mode == "run"
    assert ours.clearing is None
    assert ours.step(stopped(4, stops=2), "", DRIVE, 0).mode == "hold"


@pytest.mark.parametrize(
    "other",
    [
        stopped(2, stops=2),  # it had left the stop, and is in the next one
        stopped(2, stops=1, mode="stopped"),
        stopped(
            2, stops=1, reason="ready again, acknowledge to drive"
        ),  # it could not have been driven before
        stopped(2, stops=1, holder=8, holder_name="bob"),
    ],
)
def test_what_has_changed_meanwhile_is_not_acknowledged(other):
    ours = Supervision(7, "operator")
    ours.clear(stopped(1, stops=1))
    ours.step(other, "", DRIVE, 0)
    assert ours.clearing is None


def test_it_never_engages_a_device():
    ours = Supervision(7, "operator")
    ours.clear(stopped(1))
    assert ours.step(stopped(2), "", SteeringInput(), 0).mode == "acknowledge"
    assert ours.step(state(3, mode="hold"), "", SteeringInput(), 0).reason == "device not engaged"


class Node:
    """An operator's node as far as it matters here."""

    session, fault, stopping, clearing = 7, "", False, False

    def __init__(self, shown):
        self.state = shown

    def acknowledge(self):
        self.clearing = True


@pytest.fixture
def desk():
    node, said = Node(stopped(1)), []
    server = AcknowledgeServer(node, Direct(), SimpleNamespace(now_ns=lambda: 0), Silent(), "r", said.append)
    server.close()
    return SimpleNamespace(node=node, server=server, said=said)


def test_the_operators_program_says_what_it_cleared_once_the_robot_has_been_out_of_it(desk):
    first, second = Asked(), Asked()
    desk.server.look(first, 0)
    desk.server.look(second, 1)
    desk.node.clearing, desk.node.state = False, state(2, mode="hold")
    desk.server.look(None, SECOND)
    assert first.answer is None
    desk.server.look(None, 2 * SECOND)
    assert first.answer == second.answer == {"ok": True, "cleared": "emergency stop by bob"}
    assert desk.said == ["acknowledges, asked for by `farhand acknowledge`: emergency stop by bob"]


@pytest.mark.parametrize(
    ("then", "why"),
    [
        ({"clearing": False, "state": stopped(2, stops=1)}, "stopped again: emergency stop by bob"),
        (
            {"clearing": False, "state": stopped(2, reason="ready again")},
            "too early; the robot says now: ready",
        ),
        ({"clearing": False, "state": stopped(2, holder=8, holder_name="bob")}, "control was lost"),
        ({}, "has not confirmed it"),
    ],
)
def test_the_operators_program_says_why_it_was_not_cleared(desk, then, why):
    asked = Asked()
    desk.server.look(asked, 0)
    vars(desk.node).update(then)
    desk.server.look(None, 5 * SECOND)
    assert asked.answer["ok"] is False
    assert why in asked.answer["error"]


@pytest.mark.parametrize(
    ("node", "why"),
    [
        ({"fault": "margin law 'mine': broke"}, "stands for good, and must be started again: margin law"),
        ({"stopping": True}, "an emergency stop is on its way"),
        ({"state": state(1)}, "nothing to acknowledge"),
    ],
)
def test_the_operators_program_refuses_what_it_cannot(desk, node, why):
    vars(desk.node).update(node)
    asked = Asked()
    desk.server.look(asked, 0)
    assert why in asked.answer["error"]
    assert not desk.node.clearing


class Bench:
    """A real watchdog, and `farhand acknowledge` before it, tick by tick."""

    def __init__(self, broken=False):
        self.watchdog, self.broken = Watchdog(SafetySettings(), 9), broken
        self.clearing = Clearing("r", "carol", 77)
        self.sent, self.seq = [], 0
        self.decode = Decoder(VelocityCommand).decode

    def run(self, seconds):
        watchdog = self.watchdog
        for k in range(1, round(seconds * 10)):
            now = k * SECOND // 10
            watchdog.tick(now)
            if self.broken:
                watchdog.fault("it broke", now)
            lease = watchdog.lease
            shown = state(k, t_sent_ns=now, mode=watchdog.mode, reason=watchdog.reason, holder=lease.holder,
                          holder_name=lease.holder_name, stops=watchdog.stops)  # fmt: skip
            self.clearing.see(encode(shown), now)
            payload = self.clearing.step(now, now / SECOND)
            if payload is not None:
                self.sent.append(self.decode(payload))
                watchdog.receive(self.sent[-1], now)
            if self.clearing.done:
                return
        return


def test_where_nobody_has_control_the_robot_is_told_and_control_is_given_up():
    bench = Bench()
    bench.watchdog.receive(VelocityCommand(source="bob", session=99, seq=0, t_sent_ns=0, mode="estop",
                                           velocity=(0.0, 0.0, 0.0)), 0)  # fmt: skip
    bench.run(5)
    assert (bench.clearing.done, bench.clearing.refusal) == (True, "")
    assert bench.clearing.cleared == "emergency stop by bob"
    assert (bench.watchdog.mode, bench.watchdog.lease.holder) == ("hold", 0)
    assert {command.mode for command in bench.sent} == {"acknowledge", "hold", "release"}
    assert {command.velocity for command in bench.sent} == {(0.0, 0.0, 0.0)}


def test_a_fault_that_lasts_cannot_be_cleared_and_is_left_alone():
    bench = Bench(broken=True)
    bench.watchdog.fault("it broke", 0)
    bench.run(5)
    assert bench.clearing.refusal == "the robot stopped again: fault: it broke"
    assert bench.watchdog.lease.holder == 0
    assert [command.mode for command in bench.sent] == ["acknowledge", "release"]


def test_where_another_one_has_control_it_is_said_who_and_nothing_is_sent():
    clearing = Clearing("r", "carol", 77)
    clearing.see(encode(stopped(1, holder=8, holder_name="bob")), 0)
    assert clearing.step(0, 0.0) is None
    assert not clearing.done
    assert clearing.step(9 * SECOND, 9.0) is None
    assert "bob holds control, and acknowledges (emergency stop by bob)" in clearing.refusal


@pytest.mark.realtime
@pytest.mark.parametrize("way", ["operator", "robot"])
def test_a_real_robot_leaves_its_emergency_stop(way, tmp_path, capsys):
    up, reports = (f"tcp/127.0.0.1:{port}" for port in free_ports(2))
    task = ("--scenario", short_task(tmp_path, FAR), "--robot", "r")
    with Programs() as programs:
        programs.start("robot", *task, "--listen", up)
        if way == "operator":
            programs.start("operator", *task, "--connect", up, "--report", reports)
        witness = Witness(up)
        try:
            end = reports if way == "operator" else up
            if way == "operator":
                witness.wait_until(lambda s: s.mode == "run" and s.velocity[0] > 0.1)
            else:
                witness.wait_until(lambda s: s.mode == "hold")
            assert acknowledge("r", [end], "") == 1
            assert "nothing to acknowledge" in capsys.readouterr().err
            assert emergency_stop("r", [end], "") == 0
            witness.wait_until(lambda s: s.mode == "estop")
            assert acknowledge("r", [end], "") == 0
            assert "r has left its stop (emergency stop by" in capsys.readouterr().out
            witness.forget()
            witness.wait_until(lambda s: s.mode == ("run" if way == "operator" else "hold"))
        finally:
            witness.close()


@pytest.mark.realtime
def test_nobody_there_clears_nothing(capsys):
    assert acknowledge("r", [f"tcp/127.0.0.1:{free_ports(1)[0]}"], "") == 1
    assert "NOT CLEARED: robot 'r' and its operator have not answered" in capsys.readouterr().err
