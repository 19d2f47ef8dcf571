"""A thread with a real-time loop says nothing, opens nothing, writes nothing and answers nobody.

Each program's loop runs here in a thread called "loop", with all that the program hangs onto it; everything
that prints, opens, writes or answers notes the thread that it is in.
"""

import builtins
import io
import sys
import threading

import msgspec
import pytest

from farhand.common.link.link import Packet, memory_wire
from farhand.common.link.requests import Desk
from farhand.common.messages.base import Echo
from farhand.common.messages.codec import encode
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.keys import command_key
from farhand.common.process.teller import Teller
from farhand.common.recording.reader import read_run
from farhand.common.recording.records import RunInfo
from farhand.common.recording.run_file import RunFile
from farhand.common.timing.clock import SystemClock
from farhand.common.timing.loop import RealtimeLoop
from farhand.common.timing.slot import Slot
from farhand.netem.action import Action
from farhand.netem.announcer import Announcer
from farhand.netem.control import answer
from farhand.netem.emulation import Emulation
from farhand.netem.measure.message_log import CsvLog, read_log
from farhand.netem.netem_node import NetemNode
from farhand.netem.spec import parse_spec
from farhand.operator_side.accounts.tick_history import TickHistory
from farhand.operator_side.control.registry import make_controller
from farhand.operator_side.main import ReportPublisher, run_operator
from farhand.operator_side.operator_node import OperatorIdentity
from farhand.programs.following.followed_run import FollowedRun
from farhand.programs.operator import Course
from farhand.programs.wiring import make_operator
from farhand.robot_side.main import run_robot
from farhand.robot_side.robot_node import RobotNode
from farhand.robot_side.robots.registry import make_robot
from farhand.runs.scenario import load_scenario, replace_setting
from farhand.site.handover import HandoverServer
from farhand.site.tick_server import TickServer
from tests.farhand.site.fakes import Silent

INFO = RunInfo(scenario={"name": "x"}, robot="r", session=3, seed=1, versions={"python": "3"})
PATIENCE = 20.0


class Watched:
    """Which thread printed, opened or wrote; audited calls of the interpreter come with it."""

    def __init__(self):
        self.deeds = set()
        self.on = False

    def note(self, what):
        if self.on:
            self.deeds.add((threading.current_thread().name, what))

    def audit(self, event, arguments):
        if event in ("open", "socket.connect", "socket.sendto", "subprocess.Popen", "os.truncate"):
            self.note(f"{event} {arguments[0]!r}")

    def of_loop(self):
        return {deed for thread, deed in self.deeds if thread == "loop"}

    def threads(self, what):
        return {thread for thread, deed in self.deeds if deed == what}


WATCHED = Watched()
sys.addaudithook(WATCHED.audit)  # there is no taking it away again


class Terminal(io.StringIO):
    def write(self, text):
        WATCHED.note("terminal")
        return super().write(text)


@pytest.fixture
def watch(monkeypatch):
    """Begins to watch; to be called in the test itself, as pytest puts its own terminal there before."""

    def begin():
        monkeypatch.setattr(sys, "stderr", terminal := Terminal())
        printing = builtins.print
        monkeypatch.setattr(builtins, "print", lambda *a, **k: (WATCHED.note("print"), printing(*a, **k)))
        WATCHED.deeds, WATCHED.on, WATCHED.terminal = set(), True, terminal
        return WATCHED

    yield begin
    WATCHED.on = False


def in_loop_thread(run):
    failed = []

    def guarded():
        try:
            run()
        except BaseException as error:
            failed.append(error)

    thread = threading.Thread(target=guarded, name="loop", daemon=True)
    thread.start()
    return thread, failed


def wait_until(holds):
    pause = threading.Event()
    for _ in range(int(PATIENCE / 0.005)):
        if holds():
            return
        pause.wait(0.005)
    raise AssertionError("it did not come to pass")


def scenario():
    return replace_setting(load_scenario("point-obstacle"), "controller.kind", "pass-through")


def test_the_watch_sees_what_a_loop_must_not_do(watch, tmp_path):
    watched = watch()

    def bad():
        print("x", file=sys.stderr)
        (tmp_path / "x").write_text("x")

    thread, failed = in_loop_thread(bad)
    thread.join(PATIENCE)
    assert not failed
    assert watched.of_loop() == {"print", "terminal", f"open {str(tmp_path / 'x')!r}"}


def test_the_robots_loop(watch):
    settings = scenario()
    watched = watch()
    watched.on = False
    far, link = memory_wire()
    stop, teller = threading.Event(), Teller("robot")
    thread, failed = in_loop_thread(
        lambda: run_robot(
            RobotNode(settings, make_robot(settings), link, "r", 9),
            SystemClock(),
            stop,
            realtime=False,
            say=teller.say,
        )
    )
    wait_until(far.receive)  # the robot is made, and its loop turns
    watched.on = True
    for seq in range(3):
        command = VelocityCommand(
            source="o", session=5, seq=seq, t_sent_ns=1, mode="acknowledge", velocity=(0.0, 0.0, 0.0),
            echo=Echo(1, 1, 1, 0),
        )  # fmt: skip
        far.send(Packet(command_key("r"), encode(command)))
    wait_until(lambda: "refused" in watched.terminal.getvalue())
    watched.on = False  # the result is made after the loop
    stop.set()
    thread.join(PATIENCE)
    teller.close()
    assert not failed
    assert watched.threads("terminal") == watched.threads("print") == {"teller"}
    assert watched.of_loop() == set()


def test_the_operators_loop(watch):
    _, link = memory_wire()
    reports, report_end = memory_wire()
    stop, clock, slot = threading.Event(), SystemClock(), Slot()
    settings = scenario()
    controller = make_controller(settings.controller)
    controller.prepare()
    node = make_operator(settings, link, OperatorIdentity("r", 7, "o"), controller)
    watched, teller = watch(), Teller("operator")
    course = Course(node, settings, teller.say)
    node.listeners += [course, ReportPublisher(report_end, "r")]
    node.recorder = TickHistory()
    handover = HandoverServer(node, slot, clock, None, "r", "", teller.say)
    thread, failed = in_loop_thread(lambda: run_operator(node, clock, stop, slot=slot, realtime=False))
    wait_until(lambda: course.tally.ticks >= 3)
    assert slot.do(lambda _: threading.current_thread().name) == "loop"
    stop.set()
    thread.join(PATIENCE)
    handover.close()
    assert len(reports.receive()) == course.tally.ticks == len(course.series.samples())
    assert len(node.recorder.since(0)[0]) == course.tally.ticks
    teller.close()
    assert "no state from the robot yet" in watched.terminal.getvalue()
    assert not failed
    assert watched.of_loop() == set()


class Waiting:
    """In place of requests from the wire: answers are kept."""

    def __init__(self, payload):
        self.payload, self.answers, self.threads = payload, [], set()
        self.given = False

    def get(self, patience):
        if self.given:
            threading.Event().wait(0.001)
            return None
        self.given = True
        return self

    def reply(self, answer):
        self.threads.add(threading.current_thread().name)
        self.answers.append(msgspec.json.decode(answer))


class Emulator:
    """netem as its program runs it, between two ends in memory."""

    def __init__(self, tmp_path, teller):
        self.operator, operator_end = memory_wire()
        self.robot, robot_end = memory_wire()
        self.path, clock = tmp_path / "log.csv", SystemClock()
        self.log = CsvLog(self.path)
        spec = parse_spec("constant:1")
        self.node = NetemNode(operator_end, robot_end, Emulation(spec, spec, 1), logs=[self.log])
        self.over = threading.Event()
        self.loop = RealtimeLoop(
            self.node, clock, message_driven=True, realtime=False, until=lambda _: self.over.is_set()
        )
        self.slot, self.steps = Slot(self.loop.notify), 0
        self.loop.before.append(self.slot.serve)
        self.loop.after += [Announcer(teller.say, self.node).look, self._count]
        self.operator.peer.on_arrival = lambda now_ns: self.loop.notify()
        self.thread, self.failed = in_loop_thread(self.loop.run)

    def _count(self, now_ns):
        self.steps += 1

    def send(self):
        self.operator.send(Packet("farhand/r/command", b"x", self.loop._clock.now_ns()))

    def close(self):
        self.over.set()
        self.thread.join(PATIENCE)
        self.log.close()
        assert not self.failed


def test_the_emulators_loop(watch, tmp_path):
    watched = watch()
    watched.on = False
    teller = Teller("netem")
    emulator = Emulator(tmp_path, teller)
    watched.on = True
    emulator.send()
    wait_until(lambda: emulator.robot.inbox._packets)
    emulator.node.note("a timeline's line")
    request = Waiting(msgspec.json.encode({"do": "set", "spec": "constant:2"}))
    desk = Desk(
        "control", lambda r: r and r.reply(answer(emulator.node, r.payload, emulator.slot.do)), request
    )
    wait_until(lambda: request.answers)
    desk.close()
    emulator.close()
    teller.close()
    assert request.answers[0]["specs"] == {"uplink": "constant:2", "downlink": "constant:2"}
    assert request.threads == {"control"}
    assert "a timeline's line" in watched.terminal.getvalue()
    assert watched.of_loop() == set()
    assert len(read_log(emulator.path)) == 1
    assert emulator.log.missing == 0


def test_a_request_that_takes_long_holds_nobody_up(watch, tmp_path, monkeypatch):
    watched = watch()
    watched.on = False
    teller, checking, free = Teller("netem"), threading.Event(), threading.Event()
    emulator = Emulator(tmp_path, teller)
    check = Action.check

    def slow(action):
        if threading.current_thread().name == "control":
            checking.set()
            assert free.wait(PATIENCE)
        check(action)

    monkeypatch.setattr(Action, "check", slow)
    request = Waiting(msgspec.json.encode({"do": "outage", "length": 0.001}))
    desk = Desk(
        "control", lambda r: r and r.reply(answer(emulator.node, r.payload, emulator.slot.do)), request
    )
    assert checking.wait(PATIENCE)
    before = emulator.steps
    for _ in range(20):
        emulator.send()
        wait_until(lambda: emulator.robot.receive())
    assert emulator.steps >= before + 20
    assert request.answers == []
    free.set()
    wait_until(lambda: request.answers)
    assert request.answers[0]["ok"]
    desk.close()
    emulator.close()
    teller.close()


def test_what_a_program_keeps_for_its_recorder_is_whole(tmp_path):
    """What the loop hands over is all in the file, under its real name."""
    _, link = memory_wire()
    stop, clock, path = threading.Event(), SystemClock(), tmp_path / "run.mcap"
    settings = scenario()
    controller = make_controller(settings.controller)
    node = make_operator(settings, link, OperatorIdentity("r", 7, "o"), controller)
    node.recorder = TickHistory()
    server = TickServer(node.recorder, INFO, Silent(), clock.now_ns)
    ticks = []
    node.listeners += [ticks.append, lambda report: len(ticks) == 3 and stop.set()]
    run_operator(node, clock, stop, realtime=False)
    recording = FollowedRun(lambda info: RunFile(path, info))
    recording.take(server.answer(b'{"since": 0}'))
    recording.close()
    server.close()
    run = read_run(path)
    assert run.complete
    assert [record.report for record in run.ticks] == [encode(report) for report in ticks]
