"""Two operators and one robot: in virtual time over a network that delays, and as real programs."""

import json
import signal

import pytest

from farhand.common.errors import InputError
from farhand.common.link.link import Packet, memory_wire
from farhand.common.link.ports import free_ports
from farhand.common.messages.codec import Decoder
from farhand.common.messages.state import RobotState
from farhand.common.recording.records import RunInfo
from farhand.common.recording.writer import RunRecorder
from farhand.laboratory.replay import replay
from farhand.operator_side.control.registry import make_controller
from farhand.operator_side.operator_node import OperatorIdentity
from farhand.operator_side.steering.device import SteeringInput
from farhand.programs.command_line import OperatorWords, RobotWords
from farhand.programs.wiring import make_operator, make_robot_node, versions
from farhand.runs.scenario import load_scenario, replace_setting, scenario_to_table
from farhand.site.handover import choose
from farhand.site.operator_name import operator_name
from farhand.testing import ScriptedDevice, Witness, short_task, state
from farhand.testing.programs import ask_farhand

MS = 1_000_000
STEP = 10 * MS
FORWARD = (0.2, 0.0, 0.0)


class Bench:
    """One robot, and operators that come and go; every message takes `delay_ms`."""

    def __init__(self, delay_ms):
        settings = load_scenario("point-obstacle")
        self.scenario = replace_setting(settings, "controller.kind", "pass-through")
        self.delay, self.now = delay_ms * MS, 5_000 * MS
        self.far, link = memory_wire()
        self.robot = make_robot_node(self.scenario, link, "r", 99)
        self.operators, self.links, self.wires, self.due = {}, {}, [], {}
        self.states = []

    def start(self, name, session):
        far, link = memory_wire()
        controller = make_controller(self.scenario.controller)
        node = make_operator(
            self.scenario,
            link,
            OperatorIdentity("r", session, name),
            controller,
            device=ScriptedDevice(FORWARD),
        )
        self.operators[session], self.links[session], self.due[session] = node, far, self.now
        return node

    def kill(self, session):
        del self.operators[session], self.links[session]

    def run(self, ms, until=lambda state: False):
        """Let time pass; the robot's newest state, at the latest when `until` holds for it."""
        end = self.now + ms * MS
        while self.now < end and not (self.states and until(self.states[-1])):
            for wire in [w for w in self.wires if w[0] <= self.now]:
                self.wires.remove(wire)
                wire[1].send(Packet(wire[2].key, wire[2].payload))
            self.robot.step(self.now)
            for packet in self.far.receive():
                for link in self.links.values():
                    self.wires.append((self.now + self.delay, link, packet))
                if packet.key.endswith("/state"):
                    self.states.append(Decoder(RobotState).decode_or_raise(packet.payload))
            for session, node in list(self.operators.items()):
                if self.due[session] <= self.now:
                    self.due[session] = node.step(self.now)
                for packet in self.links[session].receive():
                    self.wires.append((self.now + self.delay, self.far, packet))
            self.now += STEP
        return self.states[-1]


@pytest.fixture(params=[0, 130, 450], ids="{} ms".format)
def bench(request):
    """Alice (7) drives; Bob (8) came later and waits."""
    bench = Bench(request.param)
    bench.start("alice", 7)
    bench.run(2_500, lambda s: s.mode == "run")
    bench.start("bob", 8)
    state = bench.run(2_500)
    assert (state.holder, state.holder_name, state.waiting, state.mode) == (7, "alice", ((8, "bob"),), "run")
    assert bench.operators[8].report.stop_reason.startswith("alice holds control; waiting; it can hand over")
    assert set(state.refused) == {"held"}
    return bench


def test_a_handover_and_back(bench):
    alice, bob = bench.operators[7], bench.operators[8]
    alice.hand_over(8)
    state = bench.run(3_000, lambda s: s.holder == 8)
    assert (state.holder_name, state.mode, state.reason) == ("bob", "hold", "control was handed over to bob")
    state = bench.run(4_000)
    assert (state.holder, state.mode, state.applied_session, state.stops) == (8, "run", 8, 0)
    assert state.waiting == ((7, "alice"),)
    assert alice.report.stop_reason.startswith("bob holds control; waiting")
    bob.hand_over(7)
    state = bench.run(4_000)
    assert (state.holder_name, state.mode, state.waiting) == ("alice", "run", ((8, "bob"),))


def test_a_run_with_a_handover_replays_to_the_byte(tmp_path):
    bench, path = Bench(130), tmp_path / "run.mcap"
    table = scenario_to_table(bench.scenario)
    info = RunInfo(scenario=table, robot="r", session=7, seed=0, versions=versions(), operator="alice")
    alice = bench.start("alice", 7)
    alice.recorder = RunRecorder(path, info)
    try:
        bench.run(2_000)
        bob = bench.start("bob", 8)
        bench.run(2_000)
        alice.hand_over(8)
        bench.run(3_000)
        bob.hand_over(7)
        bench.run(2_000)
    finally:
        alice.recorder.close()
    result = replay(path)
    modes = [tick.recorded.mode for tick in result.ticks]
    assert modes.count("release") >= 2
    assert modes[-1] == "run"
    assert any("bob holds control" in tick.recorded.stop_reason for tick in result.ticks)
    assert result.identical


def test_control_that_was_released_goes_to_who_waits(bench):
    bench.operators[7].release(bench.now)
    bench.run(20 + bench.delay // MS)
    bench.kill(7)
    state = bench.run(4_000)
    assert (state.holder_name, state.mode, state.lease_end, state.stops) == ("bob", "run", "released", 0)


def test_control_of_one_that_fell_silent_is_taken_only_by_a_persons_act(bench):
    bench.kill(7)
    before = bench.now
    state = bench.run(20_000)
    assert (state.holder, state.lease_end, state.mode, state.waiting) == (0, "silent", "stopped", ())
    meanwhile = [s.holder for s in bench.states if before < s.t_sent_ns < before + 1_800 * MS]
    assert set(meanwhile) == {7}
    assert len(meanwhile) >= 89  # 50 a second
    bob = bench.operators[8]
    assert bob.report.stop_reason == "alice lost control without releasing it; acknowledge to take it"
    bob.device.wants = SteeringInput(FORWARD, engaged=True, acknowledge=True)
    state = bench.run(3_000, lambda s: s.holder == 8)
    bob.device.wants = SteeringInput(FORWARD, engaged=True)
    state = bench.run(3_000)
    assert (state.holder_name, state.mode) == ("bob", "run")


@pytest.mark.parametrize("pause_ms", [200, 1_500, 4_000])
def test_an_operator_that_is_started_again_goes_on_by_itself(bench, pause_ms):
    bench.kill(7)
    bench.run(pause_ms)
    again = bench.start("alice", 70)
    state = bench.run(8_000, lambda s: s.holder == 70)
    assert state.holder_name == "alice"
    assert again.report.mode in ("hold", "acknowledge")
    again.device.wants = SteeringInput(FORWARD, engaged=True, acknowledge=True)  # the robot stopped
    state = bench.run(3_000, lambda s: s.mode == "run")
    assert (state.holder, state.mode) == (70, "run")


def test_a_robot_that_is_started_again_goes_to_its_holder_and_not_to_who_waits(bench):
    bench.far, link = memory_wire()
    bench.robot = make_robot_node(bench.scenario, link, "r", 100)
    bench.wires.clear()
    state = bench.run(4_000)
    assert (state.session, state.holder_name, state.mode) == (100, "alice", "run")


def test_to_whom_control_goes():
    def seen(*waiting, holder=7):
        return state(holder=holder, holder_name="alice" if holder else "", waiting=waiting)

    bob, eve = (8, "bob"), (9, "eve")
    assert choose(seen(bob), 7, "") == bob
    assert choose(seen(bob, eve), 7, "eve") == eve
    for shown, me, to, line in (
        (None, 7, "", "does not hold control; nobody does"),
        (seen(bob, holder=0), 7, "bob", "does not hold control; nobody does"),
        (seen(bob), 8, "bob", "does not hold control; alice does"),
        (seen(), 7, "", "nobody waits"),
        (seen(), 7, "bob", "nobody waits"),
        (seen(bob), 7, "eve", "--to 'eve': does not wait for control; waiting: bob"),
        (seen(bob, eve), 7, "", "2 wait for control: bob, eve; --to says which"),
        (seen(bob, (9, "bob")), 7, "bob", "give them different names"),
    ):
        with pytest.raises(InputError, match=line):
            choose(shown, me, to)


def test_the_name_of_an_operator_is_printable(monkeypatch):
    assert operator_name("Bob B.", None) == "Bob B."
    monkeypatch.setattr("getpass.getuser", lambda: "b\x1bob")
    monkeypatch.setattr("socket.gethostname", lambda: "h" * 80)
    assert operator_name("", None) == "b?ob@" + "h" * 59


@pytest.mark.realtime
def test_programs_hand_over_and_the_lease_of_a_killed_one_ends(started, tmp_path):
    path = str(short_task(tmp_path, targets=[(0.7, 0.0, 0.5), (0.0, 0.0, 0.5)] * 60))
    endpoint, *reports = (f"tcp/127.0.0.1:{port}" for port in free_ports(3))

    def operator(name, report):
        return started(OperatorWords(scenario=path, robot="r", connect=(endpoint,), report=report, name=name))

    def handover(report, *words):
        return ask_farhand("handover", "--robot", "r", "--connect", report, *words)

    started(RobotWords(scenario=path, robot="r", listen=(endpoint,)))
    alice = operator("alice", reports[0])
    witness = Witness(endpoint, reports=reports[1])
    try:
        witness.wait_until(lambda s: s.holder_name == "alice" and s.mode == "run")
        bob = operator("bob", reports[1])
        line = bob.wait_for("alice holds control")
        assert line.endswith("waiting; it can hand over to you with `farhand handover --to bob --robot r`")
        assert alice.wait_for("bob asks for control").endswith(f"--connect {reports[0]}` hands over")
        refused = "farhand: --to 'eve': does not wait for control; waiting: bob"
        assert handover(reports[0], "--to", "eve") == (2, refused)
        said = [report.stop_reason for report in witness.reports]
        assert any(reason.startswith("alice holds control; waiting") for reason in said)

        assert handover(reports[0]) == (0, "bob holds control of r")
        alice.wait_for("handed control over to bob")
        if not any("bob holds control; waiting" in line for line in alice.said):  # said by another thread
            alice.wait_for("bob holds control; waiting")
        witness.wait_until(lambda s: s.holder_name == "bob" and s.mode == "run")
        waiting = witness.wait_until(lambda s: dict(s.waiting).values()).waiting
        assert [name for _, name in waiting] == ["alice"]
        assert handover(reports[0]) == (2, "farhand: this operator does not hold control; bob does")
        code, shown = ask_farhand("robots", "--connect", endpoint, "--json")
        (row,) = json.loads(shown.splitlines()[-1])["robots"]
        assert (code, row["control"], row["waiting"]) == (0, "bob", "alice")

        bob.signal(signal.SIGKILL)
        ended = witness.wait_until(lambda s: s.holder == 0)
        assert ended.lease_end == "silent"
        witness.wait_until(lambda s: s.holder_name == "alice" and s.mode == "run")
        alice.wait_for("bob lost control without releasing it")
        alice.wait_for("driving")
    finally:
        witness.close()
