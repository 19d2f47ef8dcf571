"""`farhand robot` and `farhand operator` as processes, and what strangers on the wire may do to them."""

import json
import signal
import threading
from pathlib import Path

import msgpack
import numpy as np
import pytest
import zenoh

from farhand.common.link.link import Packet
from farhand.common.link.ports import free_ports
from farhand.common.link.zenoh_link import ZenohLink, open_session
from farhand.common.messages.base import SCHEMA, Echo
from farhand.common.messages.codec import encode
from farhand.common.messages.keys import command_key
from farhand.common.recording.reader import read_run
from farhand.common.timing.clock import SystemClock
from farhand.common.timing.loop import RealtimeLoop
from farhand.netem.measure.message_log import read_log
from farhand.programs.command_line import NetemWords, OperatorWords, RecordWords, RobotWords
from farhand.site.tap import run_tap
from farhand.testing import Witness, command, echo_of, short_task
from farhand.testing.programs import PATIENCE
from tests.examples import also

pytestmark = pytest.mark.realtime
MS = 1_000_000


class Client(Witness):
    """One that sends commands, too, as an operator would."""

    def __init__(self, endpoint, session):
        super().__init__(endpoint)
        self.me, self.seq, self.clock = session, 0, SystemClock()

    def command(self, mode="run", velocity=(0.1, 0.0, 0.0), state=None, **changes):
        self.seq += 1
        state = state or self.wait_until(lambda s: True)
        fields = {"session": self.me, "t_sent_ns": self.clock.now_ns(), "echo": echo_of(state)} | changes
        return command(fields.pop("seq", self.seq), mode, source="client", velocity=velocity, **fields)

    def put(self, payload):
        self.session.put(command_key("r"), payload, congestion_control=zenoh.CongestionControl.BLOCK)

    def take_control(self):
        self.put(encode(self.command("acknowledge", (0.0, 0.0, 0.0))))
        return self.wait_until(lambda s: s.holder == self.me)

    def drive(self, velocity):
        """Until the robot runs with it; returns the bytes that made it."""
        payload = encode(self.command("run", velocity))
        self.put(payload)
        self.wait_until(lambda s: s.mode == "run" and s.applied_seq == self.seq)
        return payload

    def release(self):
        self.put(encode(self.command("release", (0.0, 0.0, 0.0))))
        return self.wait_until(lambda s: s.holder == 0 and max(map(abs, s.velocity)) < 1e-9)


def test_a_silent_operator_makes_the_robot_hold_then_stop_and_it_goes_on_after(
    started, scenario, endpoint, tmp_path
):
    """Operator and robot directly, with no netem between; the operator is frozen in the middle."""
    robot = started(
        RobotWords(scenario=scenario, robot="r", listen=(endpoint,), result=str(tmp_path / "r.json"))
    )
    operator = started(OperatorWords(scenario=scenario, robot="r", connect=(endpoint,)))
    listener = Witness(endpoint)
    try:
        listener.wait_until(lambda s: s.mode == "run" and s.velocity[0] > 0.1)
        for program in (robot, operator):  # a mesh may come at any time, and waits for nothing to be loaded
            assert "_qhull" in Path(f"/proc/{program.pid}/maps").read_text()
        operator.signal(signal.SIGSTOP)
        listener.forget()
        stopped = listener.wait_until(lambda s: s.mode == "stopped" and max(map(abs, s.velocity)) < 1e-6)
        modes = [s.mode for s in listener.states]
        order = [m for m, before in zip(modes, [None, *modes], strict=False) if m != before]
        assert order[-2:] == ["hold", "stopped"]
        assert set(order) <= {"run", "hold", "stopped"}
        assert "no good command" in stopped.reason
        assert stopped.stops == 1
        operator.signal(signal.SIGCONT)
        moving = listener.wait_until(lambda s: s.mode == "run")
        assert moving.position == pytest.approx(stopped.position, abs=0.05)
        assert operator.wait() == 0
        released = listener.wait_until(lambda s: s.holder == 0)
        assert released.position == pytest.approx((0.7, 0.0, 0.5), abs=0.03)
    finally:
        listener.close()
    assert robot.interrupt() == 0
    result = json.loads((tmp_path / "r.json").read_text())
    assert result["stops"] == 1
    assert result["commands_received"] > 10


@pytest.mark.parametrize("number", [signal.SIGINT, also(signal.SIGTERM), also(signal.SIGHUP)])
def test_each_signal_ends_a_program_with_its_result_and_releases_what_it_holds(
    started, endpoint, tmp_path, number
):
    far = str(short_task(tmp_path, [(50.0, 0.0, 0.5)]))
    down, report = (f"tcp/127.0.0.1:{port}" for port in free_ports(2))
    files = {n: tmp_path / f"{n}.json" for n in ("o", "n", "r")}
    netem = started(
        NetemWords(
            listen_operator=endpoint, listen_robot=down, stats=str(files["n"]), log=str(tmp_path / "log.csv")
        )
    )
    robot = started(RobotWords(scenario=far, robot="r", connect=(down,), result=str(files["r"])))
    operator = started(
        OperatorWords(
            scenario=far,
            robot="r",
            connect=(endpoint,),
            result=str(files["o"]),
            report=report,
        )
    )
    recorder = started(RecordWords(connect=report, robot="r", out=str(tmp_path / "run.mcap")))
    recorder.wait_for("records run")
    witness = Witness(endpoint)
    try:
        witness.wait_until(lambda s: s.mode == "run" and s.velocity[0] > 0.1)
        operator.signal(number)
        assert operator.wait() == 1
        assert recorder.wait() == 0  # it ends with the operator's program, and has all
        assert witness.wait_until(lambda s: s.holder == 0).lease_end == "released"
    finally:
        witness.close()
    for program in (robot, netem):
        program.signal(number)
        assert program.wait() == 0
    assert not json.loads(files["o"].read_text())["finished"]
    assert json.loads(files["r"].read_text())["commands_received"] > 0
    assert json.loads(files["n"].read_text())["version"] == 1
    assert read_run(tmp_path / "run.mcap").complete
    assert len(read_log(tmp_path / "log.csv")) > 0


def test_a_hostile_client_moves_nothing(started, scenario, endpoint, capsys):
    robot = started(RobotWords(scenario=scenario, robot="r", listen=(endpoint,)))
    client = Client(endpoint, session=77)
    rng = np.random.default_rng(1)
    try:
        client.wait_until(lambda s: True)
        client.take_control()
        good = client.drive((0.1, 0.0, 0.0))
        old = client.states[-1]
        rest = client.release()
        assert rest.position[0] > 0.0
        before = rest.refused
        client.wait_until(lambda s: s.t_sent_ns - old.t_sent_ns > 1_500 * MS)  # older than max_age

        table = msgpack.unpackb(good)
        del table["check"]
        fresh = table | {"session": 5, "seq": 1, "echo": None}
        attacks = {
            "malformed": [good[:n] for n in range(1, len(good), 7)] + [good + b"\x00"] * 9,
            "length": [b"", b"\xff" * 2_000_000, msgpack.packb(fresh | {"velocity": [1.0, 0.0]})],
            "non-finite": [msgpack.packb(fresh | {"velocity": [v, 0.0, 0.0]}) for v in (float("nan"), float("inf"))],
            "schema": [msgpack.packb(fresh | {"schema": SCHEMA + 1})],
            "unknown-field": [msgpack.packb(fresh | {"thrust": 1.0})],
            "type": [msgpack.packb(fresh | {"velocity": "fast"}), msgpack.packb([1, 2, 3])],
            "checksum": [good.replace(b"\xa3run", b"\xa3ruN")[:-4] + b"\0\0\0\0", msgpack.packb(table | {"check": 1})],
            "old-seq": [good] * 20,
            "no-echo": [msgpack.packb(fresh)],
            "foreign-echo": [encode(client.command(session=6, echo=Echo(1, 1, old.t_sent_ns, 0)))],
            "stale": [encode(client.command(state=old, seq=1000 + k, velocity=(0.3, 0.0, 0.0))) for k in range(300)],
        }  # fmt: skip
        attacks["type"].append(attacks["checksum"].pop(0))  # an unknown mode is found before the checksum
        noise = [rng.bytes(int(n)) for n in rng.integers(1, 400, 200)]
        client.forget()
        for payload in [*noise, *(p for kind in attacks.values() for p in kind)]:
            client.put(payload)
        sent = len(noise) + sum(map(len, attacks.values()))

        def total(state):
            return sum(state.refused.values()) - sum(before.values())

        after = client.wait_until(lambda s: total(s) >= sent)
        assert total(after) == sent
        flooded = after.refused.get("flood", 0)
        for reason, payloads in attacks.items():
            assert after.refused.get(reason, 0) - before.get(reason, 0) >= len(payloads) - flooded, reason
        assert all(s.position == pytest.approx(rest.position, abs=1e-6) for s in client.states)
        assert {s.mode for s in client.states} == {"hold"}
        assert {s.holder for s in client.states} == {0}

        # The robot goes on, and obeys who may.
        client.me, client.seq = 78, 0
        client.take_control()
        client.drive((0.0, 0.1, 0.0))
        client.wait_until(lambda s: s.position[1] > rest.position[1] + 0.005)

        # Meanwhile anybody can look, without knowing our messages.
        kept = signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)
        try:
            assert run_tap(endpoint, "farhand/*/state", 2) == 0
        finally:
            signal.signal(signal.SIGINT, kept[0])
            signal.signal(signal.SIGTERM, kept[1])
        printed = capsys.readouterr().out.splitlines()
        assert len(printed) == 2
        assert printed[0].startswith("farhand/r/state  ")
        assert f"'schema': {SCHEMA}" in printed[0]
    finally:
        client.close()
    assert robot.interrupt() == 0


def test_an_endpoint_that_never_answers_is_told_and_tried_on(started, scenario, endpoint):
    robot = started(RobotWords(scenario=scenario, connect=(endpoint,)))
    line = robot.wait_for("nobody answers")
    assert line == f"robot: {endpoint}: nobody answers for 5 s; still trying"
    session = open_session(listen=[endpoint])
    try:
        assert robot.wait_for("connected") == f"robot: {endpoint}: connected"
    finally:
        session.close()
    assert robot.interrupt() == 0


def test_a_link_survives_the_death_of_its_peer(endpoint):
    """Publishing into nothing neither raises nor blocks, and goes on when somebody is there again."""
    clock = SystemClock()
    here = ZenohLink(open_session([endpoint]), [], clock)
    try:
        for _ in range(2):
            arrived = threading.Event()
            there = ZenohLink(open_session(listen=[endpoint]), ["k/x"], clock, arrived.set)
            for _ in range(3000):
                here.send(Packet("k/x", b"hello"))
                if arrived.wait(0.01):
                    break
            assert there.receive()[0].payload == b"hello"
            assert here.connected()
            there.close()
        for _ in range(2000):
            here.send(Packet("k/x", b"nobody"))
        assert here.put_errors == 0
    finally:
        here.close()
    assert here.outbox.dropped["other"] + here.outbox.replaced["other"] < 2000


def test_the_executor_steps_at_once_when_zenoh_delivers(endpoint):
    """A node that forwards is woken by the arrival, not by its next deadline."""

    class Forwarder:
        def __init__(self, link):
            self.link, self.got = link, []

        def step(self, now_ns):
            self.got += self.link.receive()
            if self.got:
                executor.stop()
            return None

    clock = SystemClock()
    there = ZenohLink(open_session(listen=[endpoint]), ["k/y"], clock, lambda: executor.notify())
    node = Forwarder(there)
    executor = RealtimeLoop(node, clock, message_driven=True, realtime=False)
    here = ZenohLink(open_session([endpoint]), [], clock)
    thread = threading.Thread(target=executor.run)
    thread.start()
    try:
        for _ in range(3000):
            here.send(Packet("k/y", b"wake"))
            thread.join(0.01)
            if not thread.is_alive():
                break
        assert node.got[0].payload == b"wake"
    finally:
        executor.stop()
        thread.join(PATIENCE)
        here.close()
        there.close()
