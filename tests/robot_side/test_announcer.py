import msgspec
import pytest

from farhand.common.link.link import Packet
from farhand.common.messages.base import Echo
from farhand.common.messages.codec import encode
from farhand.common.messages.keys import command_key, scene_request_key
from farhand.common.messages.scene_request import SceneRequest
from farhand.robot_side.announcer import Announcer
from farhand.robot_side.safety.command_intake import CommandIntake
from farhand.robot_side.safety.scene_intake import SceneIntake
from farhand.robot_side.safety.settings import SafetySettings
from farhand.robot_side.safety.watchdog import Watchdog
from farhand.testing import command

MS = 1_000_000
ROBOT, ALICE, EVE = 7, 0xA11CE, 0xE7E


class Rig:
    """A watchdog and an intake, told what arrives, and what is said of it."""

    def __init__(self):
        self.said = []
        self.watchdog = Watchdog(SafetySettings(), ROBOT)
        self.intake = CommandIntake("r", self.watchdog)
        self.announcer = Announcer(self.said.append, self.watchdog, self.intake)
        self.now_ns = 1000 * MS

    def send(self, session, seq, mode="run", count=1, source="operator"):
        basis = Echo(ROBOT, 1, self.now_ns, 0)
        payload = encode(command(seq, mode, session=session, source=source, echo=basis))
        self.intake.take([Packet(command_key("r"), payload)] * count, self.now_ns)

    def let(self, ms):
        """Time passes; returns what was said meanwhile."""
        before = len(self.said)
        for _ in range(ms // 10):
            self.now_ns += 10 * MS
            self.watchdog.tick(self.now_ns)
            self.announcer.look(self.now_ns)
        return self.said[before:]


@pytest.fixture
def rig():
    rig = Rig()
    rig.send(ALICE, 1, "acknowledge")
    assert rig.let(300)[-1].endswith("has control")
    return rig


def test_a_stop_and_its_end_are_said(rig):
    rig.send(ALICE, 2)
    lines = rig.let(1900)
    assert [line for line in lines if line.startswith("stop: no good command for 1.5")]
    rig.send(ALICE, 3, "acknowledge")
    assert "acknowledged by operator: may move again" in rig.let(300)


def test_an_emergency_stop_of_a_robot_that_is_stopped_is_said_as_well(rig):
    rig.send(ALICE, 2)
    rig.let(1900)
    rig.send(EVE, 1, "estop", source="desk")
    assert rig.let(300) == ["stop: emergency stop by desk"]
    rig.send(EVE, 2, "estop", source="desk")
    assert not any(line.startswith("stop") for line in rig.let(300))


def test_a_fault_in_a_stop_is_said_as_well_and_what_comes_and_goes_once(rig):
    rig.send(ALICE, 2)
    rig.let(1900)
    rig.watchdog.fault("it broke", rig.now_ns)
    assert rig.let(300) == ["stop: fault: it broke"]
    for why in ("power off", "power on", "power off"):
        rig.watchdog.block(why, rig.now_ns)
        rig.let(300)
    assert [line for line in rig.said if "power" in line] == [
        "stop: fault: it broke; power off",
        "stop: fault: it broke; power on",
    ]


def test_an_intruder_is_named_once_and_then_counted(rig):
    rig.send(EVE, 1, count=100, source="eve")
    first = f"refused a command of 'eve', session {EVE:x}: of a session that does not hold control"
    assert rig.let(300)[0] == first
    for seq in range(2, 60):
        rig.send(ALICE, seq, "hold")
        rig.send(EVE, seq, count=5, source="eve")
        rig.let(200)
    assert [line for line in rig.said if "'eve'" in line] == [first, f"{first} (349 more)"]


def test_each_refusal_names_its_own_sender(rig):
    rig.send(ALICE, 1, source="alice")  # old
    rig.send(EVE, 1, source="eve")
    lines = rig.let(300)
    assert [line for line in lines if "'alice'" in line and "not newer" in line]
    assert [line for line in lines if "'eve'" in line and "does not hold control" in line]


def test_garbage_is_named_by_its_kind(rig):
    rig.intake.take([Packet(command_key("r"), b"\xc1garbage")], rig.now_ns)
    assert rig.let(300) == ["refused a command: malformed"]


def test_what_arrives_is_counted_whatever_became_of_it(rig):
    before = rig.intake.arrived
    rig.send(ALICE, 2)
    rig.send(ALICE, 2)  # a copy
    rig.send(EVE, 9)
    rig.intake.take([Packet(command_key("r"), b"x")] * 1000, rig.now_ns)
    assert rig.intake.arrived == before + 1003


def test_what_is_no_request_puts_no_letters_of_its_own_into_the_log():
    scene = SceneIntake("r", SafetySettings(), ROBOT)
    scene.take([Packet(scene_request_key("r"), msgspec.msgpack.encode({"\x1b[2J all is well": 1}))])
    assert scene.judge((), 0, lambda obstacles: "") is None
    assert scene.newest_refusal in ("what is no request (unknown-field)", "what is no request (type)")


def test_refused_changes_of_the_scene_fill_no_log():
    said, now_ns = [], 1000 * MS
    scene = SceneIntake("r", SafetySettings(), ROBOT)
    watchdog = Watchdog(SafetySettings(), ROBOT)
    announcer = Announcer(said.append, watchdog, CommandIntake("r", watchdog), scene)
    for at in range(200):  # 20 a second: all built on no state
        request = SceneRequest(source="eve", session=at + 1, seq=0, t_sent_ns=5, deed="add", base=0)
        scene.take([Packet(scene_request_key("r"), encode(request))])
        scene.judge((), now_ns, lambda obstacles: "")
        now_ns += 50 * MS
        announcer.look(now_ns)
    for _ in range(40):
        now_ns += 50 * MS
        announcer.look(now_ns)
    first = "scene: refused to eve: built on no state of this robot"
    assert said[0] == first
    assert all(line.startswith(f"{first} (") for line in said[1:])
    counts = [int(line.rpartition("(")[2].split()[0]) for line in said[1:]]
    assert 1 + sum(counts) == 200
    assert len(said) <= 1 + 12  # in 12 s
