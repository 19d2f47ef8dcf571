"""`farhand estop`: from anyone who may, by every way, latched; who may not is told before anything is sent."""

from types import SimpleNamespace

import pytest

from farhand.common.errors import InputError
from farhand.common.link.ports import free_ports
from farhand.common.messages.base import Echo
from farhand.common.messages.codec import encode
from farhand.operator_side.steering.device import SteeringInput
from farhand.operator_side.supervision import Supervision
from farhand.site.estop import EstopServer, _Stop, emergency_stop
from farhand.site.reach import check_rights
from farhand.testing import Programs, Witness, short_task, state
from tests.examples import also
from tests.farhand.site.fakes import Asked, Direct, Silent

MS = 1_000_000
FAR = [(50.0, 0.0, 0.5)]
DRIVE = SteeringInput((0.1, 0.0, 0.0), engaged=True)
ACKNOWLEDGE = SteeringInput((0.1, 0.0, 0.0), engaged=True, acknowledge=True)


def folder(role, *robots):
    return SimpleNamespace(own=SimpleNamespace(name=f"{role}.a", role=role, robots=robots))


@pytest.mark.parametrize("role", ["operator", "netem", "router"])
def test_who_may_command_may_stop(role):
    check_rights(folder(role, *(["ur5"] if role == "operator" else [])), "ur5")


@pytest.mark.parametrize(
    ("own", "said"),
    [
        (folder("observer", "ur5"), "has the role observer, which must not command"),
        (folder("robot", "ur5"), "has the role robot"),
        (folder("operator", "box"), "is for box"),
    ],
)
def test_who_may_not_is_told(own, said):
    with pytest.raises(InputError, match=said):
        check_rights(own, "ur5")


LATCHED = {"mode": "estop", "reason": "emergency stop by operator"}


def test_it_is_sent_until_the_robot_has_latched_it_then_only_an_acknowledgement_counts():
    supervision = Supervision(7, "operator")
    supervision.stop()
    assert supervision.step(None, "state", None, 0).mode == "estop"
    assert supervision.step(state(1), "", DRIVE, 0).mode == "estop"
    ours = state(2, **LATCHED, holder=7, echo=Echo(7, 1, 0, 0))
    latched = supervision.step(ours, "", DRIVE, 0)
    assert (latched.mode, supervision.estop) == ("hold", False)
    assert supervision.step(state(3, mode="estop"), "", ACKNOWLEDGE, 0).mode == "acknowledge"


def test_a_device_s_emergency_stop_ends_an_acknowledgement_and_one_given_before_counts_no_more():
    supervision = Supervision(7, "operator")
    there = state(1, **LATCHED, holder=7)
    supervision.clear(there)
    assert supervision.step(there, "", DRIVE, 0).mode == "acknowledge"
    assert supervision.step(there, "", SteeringInput(estop=True), 20 * MS).mode == "estop"
    assert supervision.step(there, "", DRIVE, 40 * MS).mode == "hold"
    supervision.stop()
    for tick in range(3):
        assert supervision.step(there, "", ACKNOWLEDGE, (60 + 20 * tick) * MS).mode == "estop"
    ours = state(2, **LATCHED, holder=7, echo=Echo(7, 9, 60 * MS, 0))
    assert supervision.step(ours, "", ACKNOWLEDGE, 140 * MS).mode == "hold"  # still held down from before
    assert supervision.step(ours, "", DRIVE, 160 * MS).mode == "hold"
    assert supervision.step(ours, "", ACKNOWLEDGE, 180 * MS).mode == "acknowledge"


def test_one_who_is_not_in_control_is_confirmed_by_a_state_that_came_late_enough_and_by_no_older_one():
    supervision = Supervision(7, "operator")
    before = state(1, **LATCHED, holder=8)
    for tick in range(500):  # 10 s in which nothing comes; asked again every second, as the command does
        if tick % 50 == 0:
            supervision.stop()
        assert supervision.step(before, "", DRIVE, 20 * tick * MS).mode == "estop"
    assert supervision.step(state(2, **LATCHED, holder=8), "", DRIVE, 10_000 * MS).mode != "estop"
    assert not supervision.estop


@pytest.mark.parametrize(
    ("reason", "said"),
    [
        ("emergency stop by {own}", True),
        ("emergency stop by {own}, and by 1 before; fault: x", True),
        ("emergency stop by anna@h", False),  # an earlier one, or of an operator's program of hers
        ("emergency stop by anna@h (call 0)", False),
        ("emergency stop by bob@h", False),
    ],
)
def test_an_emergency_stop_is_told_from_those_of_others_and_from_an_earlier_one(reason, said):
    stop = _Stop("r", "anna@h")
    stop._sent_ns = stop._clock.now_ns()
    shown = encode(state(1, mode="estop", reason=reason.format(own=stop._source)))
    stop._see(SimpleNamespace(payload=SimpleNamespace(to_bytes=lambda: shown)))
    assert stop._done.is_set() is said


def test_a_faulted_program_sends_it_until_it_is_confirmed_and_not_for_ever():
    supervision = Supervision(7, "operator")
    supervision.stop()
    supervision.confirm(None, 0)
    supervision.confirm(state(1, **LATCHED, holder=8), 500 * MS)
    assert supervision.estop
    supervision.confirm(state(2, **LATCHED, holder=8), 1000 * MS)
    assert not supervision.estop


@pytest.mark.parametrize("holder", [7, 8])
def test_a_stop_that_was_there_before_confirms_none_that_is_asked_for_while_it_is_acknowledged(holder):
    supervision = Supervision(7, "operator")
    before = state(1, **LATCHED, holder=holder, echo=Echo(7, 40, 900 * MS, 0))
    supervision.clear(before)
    supervision.step(before, "", DRIVE, 1000 * MS)
    supervision.stop()
    for tick in range(60):
        now_ns = (1020 + 20 * tick) * MS
        assert supervision.step(before, "", DRIVE, now_ns).mode == "estop"
        assert supervision.estop
    assert supervision.clearing is None
    echo = Echo(7, 90, 1500 * MS, 0) if holder == 7 else None
    assert (
        supervision.step(state(2, **LATCHED, holder=holder, echo=echo), "", DRIVE, 2220 * MS).mode != "estop"
    )
    assert not supervision.estop


class Stopping:
    stopping = False

    def emergency_stop(self):
        self.stopping = True


def test_the_operators_program_answers_once_the_robot_confirms_and_refuses_after_a_while():
    node, said = Stopping(), []
    server = EstopServer(node, Direct(), SimpleNamespace(now_ns=lambda: 0), Silent(), "r", said.append)
    server.close()
    first, second = Asked(), Asked()
    server.look(first, 0)
    assert (node.stopping, first.answer) == (True, None)
    server.look(second, 10)
    node.stopping = False
    server.look(None, 20)
    assert first.answer == second.answer == {"ok": True}
    late = Asked()
    server.look(late, 30)
    server.look(None, 5_000_000_000)
    assert late.answer["ok"] is False
    assert "goes on sending" in late.answer["error"]
    assert said == ["emergency stop, asked for by `farhand estop`"] * 2  # once while one is on its way


@pytest.mark.realtime
@pytest.mark.parametrize("way", ["robot", also("emulator"), "operator"])
def test_every_way_stops_a_driving_robot_and_it_stays_so(way, tmp_path, capsys):
    up, down, reports = (f"tcp/127.0.0.1:{port}" for port in free_ports(3))
    task = ("--scenario", short_task(tmp_path, FAR), "--robot", "r")
    with Programs() as programs:
        if way == "robot":
            programs.start("robot", *task, "--listen", up)
        else:
            programs.start("netem", "--listen-operator", up, "--listen-robot", down)
            programs.start("robot", *task, "--connect", down)
        programs.start("operator", *task, "--connect", up, "--report", reports)
        witness = Witness(up)
        try:
            witness.wait_until(lambda s: s.mode == "run" and s.velocity[0] > 0.1)
            assert emergency_stop("r", [reports if way == "operator" else up], "") == 0
            assert "r is stopped" in capsys.readouterr().out
            stopped = witness.wait_until(lambda s: s.mode == "estop")
            assert stopped.reason.startswith("emergency stop by ")
            witness.forget()
            witness.wait_for(
                lambda: len(witness.states) > 150
            )  # three seconds: the tester clears no such stop
            assert {s.mode for s in witness.states} == {"estop"}
            assert max(abs(v) for s in witness.states[-5:] for v in s.velocity) < 1e-6
        finally:
            witness.close()


@pytest.mark.realtime
def test_nobody_there_is_not_a_stop(capsys):
    assert emergency_stop("r", [f"tcp/127.0.0.1:{free_ports(1)[0]}"], "") == 1
    assert "NOT CONFIRMED" in capsys.readouterr().err
