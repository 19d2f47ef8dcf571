"""What was asked in a recorded run, played: the same stream, by the rules of hold-to-run; bad files in one line."""

from itertools import pairwise

import pytest

from farhand.cli import run
from farhand.common.errors import InputError
from farhand.common.messages.codec import Decoder
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.steering import Steering
from farhand.common.recording.reader import read_run
from farhand.laboratory.simulation import simulate
from farhand.operator_side.devices.playback_node import PlaybackNode
from farhand.operator_side.steering.hand.sender import SteeringSender
from farhand.operator_side.steering.recorded.course import Asked, Course, read_course
from farhand.operator_side.steering.recorded.playback import Playback
from farhand.operator_side.steering.recorded.recorded import SETTLES_NS, Recorded, RecordedSettings
from farhand.runs.scenario import load_scenario, replace_settings
from farhand.testing import ScriptedLink, report, state, view

MS = 1_000_000
EAST, UP = (0.2, 0.0, 0.0), (0.0, 0.0, 0.3)
TICK = 100 * MS
COURSE = Course(
    [
        (5 * TICK, Asked(1, EAST)),
        (6 * TICK, Asked(1, EAST, UP)),
        (7 * TICK, Asked()),
        (8 * TICK, Asked(2, UP)),
        (9 * TICK, Asked(2, EAST)),
    ]
)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A short run of the tester's, and its file."""
    path = tmp_path_factory.mktemp("run") / "run.mcap"
    simulate(
        load_scenario("point-obstacle"),
        uplink="constant:50",
        downlink="constant:50",
        record_to=path,
        time_limit=3.0,
    )
    return path


def played(path):
    """The scenario of that run, with its input in place of the tester."""
    return replace_settings(
        load_scenario("point-obstacle"), {"steering.kind": "recorded", "steering.recorded.run": str(path)}
    )


def drive(path):
    """Every command from the first motion on: as bytes, and what was desired."""
    sent = [tick.command for tick in read_run(path).ticks if tick.command is not None]
    found = [Decoder(VelocityCommand).decode_or_raise(payload) for payload in sent]
    first = next(n for n, command in enumerate(found) if command.mode == "run")
    return sent[first:], [command.desired for command in found[first:]]


def test_the_same_network_gives_the_same_drive_to_the_byte(recorded, tmp_path):
    again = tmp_path / "again.mcap"
    simulate(played(recorded), network="constant:50", record_to=again, time_limit=3.0)
    sent, _ = drive(again)
    assert len(sent) > 28
    assert sent == drive(recorded)[0]


def test_another_network_is_asked_for_the_same_at_the_same_offsets(recorded, tmp_path):
    other = tmp_path / "other.mcap"
    simulate(played(recorded), network="constant:200", record_to=other, time_limit=10.0)
    (_, then), (_, now) = drive(recorded), drive(other)
    assert now[: len(then)] == then
    assert set(now[len(then) :]) == {(0.0, 0.0, 0.0)}
    assert len(now) - len(then) == pytest.approx(SETTLES_NS / TICK, abs=2)  # and then it ends


def test_a_course_is_what_was_asked_from_each_instant_on_and_nothing_afterwards():
    at = [COURSE.at(ms * MS) for ms in (0, 60, 110, 260, 310, 440, 530)]
    assert [each.press for each in at] == [1, 1, 1, 0, 2, 2, 0]
    assert [each.linear for each in at] == [EAST, EAST, EAST, (0.0,) * 3, UP, EAST, (0.0,) * 3]
    assert COURSE.duration_ns == 5 * TICK
    assert COURSE.at(-30 * MS) == Asked()


def test_a_loop_that_is_a_little_early_or_late_asks_for_each_once():
    for shift in (-20, 0, 20, 70):
        found = [COURSE.at(n * TICK + shift * MS) for n in range(1, 5)]
        assert [each.press for each in found] == [1, 0, 2, 2], shift


@pytest.fixture
def device(monkeypatch):
    monkeypatch.setattr("farhand.operator_side.steering.recorded.recorded.read_course", lambda _path: COURSE)
    return Recorded(RecordedSettings(run="x"))


def test_it_begins_when_it_may_drive_and_ends_with_zero(device):
    waits = view(0, state())
    waits = type(waits)(waits.state, waits.scene, waits.targets, 0, driving=False)
    assert not device.read(waits).engaged
    assert device.read(view(7 * TICK, state())).velocity == EAST
    assert device.read(view(8 * TICK, state())).angular == UP
    assert not device.read(view(9 * TICK, state())).engaged
    assert device.read(view(10 * TICK, state())).velocity == UP
    assert not device.read(view(12 * TICK + 90 * MS, state())).engaged
    assert not device.over
    device.read(view(13 * TICK + SETTLES_NS, state()))
    assert device.over


def test_a_stop_ends_the_press_and_only_the_next_one_moves(device):
    device.read(view(0, state()))
    wants = device.read(view(TICK // 2, state(mode="stopped", reason="no command")))
    assert (wants.engaged, wants.acknowledge) == (False, False)
    assert not device.read(view(TICK, state())).engaged
    assert device.read(view(3 * TICK, state())).engaged


class Playing:
    """The program, and what it sends."""

    def __init__(self, course=COURSE):
        self.link, self.now = ScriptedLink("r"), 0
        self.node = PlaybackNode(
            Playback(course), self.link, SteeringSender("r", self.link, 1, "device", "recorded")
        )
        self.seq = 0

    def hears(self, **fields):
        self.seq += 1
        given = {"seq": self.seq, "safety": "hold", "mode": "hold", "stop_reason": "device not engaged"}
        self.link.feed(report(**given | fields), self.now)
        return self

    def after(self, ms):
        for _ in range(ms // 10):
            self.now += 10 * MS
            self.link.now_ns = self.now
            self.node.step(self.now)
        return self

    @property
    def told(self):
        return [Decoder(Steering).decode_or_raise(packet.payload) for packet in self.link.sent]


def test_the_program_plays_to_an_operator_that_waits_for_a_hand():
    playing = Playing().after(200)
    assert playing.told == []
    playing.hears(stop_reason="anna holds control; waiting").after(100)
    assert playing.told == []
    assert "anna" in playing.node.says
    playing.hears().after(300).hears(mode="run", stop_reason="").after(350)
    told = playing.told
    assert {each.unit for each in told if each.engaged} == {"si"}
    assert next(each.press for each in told if each.engaged and each.linear == EAST) == 1
    assert [each.press for each in told if each.engaged][-1] == 2
    assert told[-1].release
    assert playing.node.over
    ages = [b.t_sent_ns - a.t_sent_ns for a, b in pairwise(told) if a.engaged and b.engaged]
    assert max(ages) <= 1e9 / 30


def test_the_program_lets_go_when_the_robot_stops_and_goes_on_with_the_next_press():
    playing = Playing().hears().after(50)
    assert playing.told[-1].engaged
    playing.hears(safety="stopped", safety_reason="no command").after(50)
    assert not playing.told[-1].engaged
    playing.hears().after(50)
    assert not playing.told[-1].engaged
    playing.after(200)
    assert playing.told[-1].press == 2


@pytest.fixture
def bad(tmp_path, recorded):
    (tmp_path / "empty").write_bytes(b"")
    (tmp_path / "foreign").write_bytes(b"not a recording at all")
    (tmp_path / "cut").write_bytes(recorded.read_bytes()[: recorded.stat().st_size // 2])
    return tmp_path


@pytest.mark.parametrize(
    "command", [["simulate", "--steer"], ["demo", "--steer"], ["operator", "--steer"], ["steer"]]
)
@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("empty", "it is empty"),
        ("foreign", "not a recording of Farhand"),
        ("cut", "it is cut off"),
        ("nothing", "no such file"),
        ("", "names no run"),
    ],
)
def test_a_bad_file_is_one_line_and_code_2(bad, monkeypatch, capsys, command, name, words):
    monkeypatch.chdir(bad)
    assert run([*command, f"recorded:{name}"]) == 2
    said = capsys.readouterr()
    assert words in said.err
    assert said.err.count("\n") == 1


def test_a_run_in_which_nothing_was_driven_cannot_be_played(tmp_path):
    path = tmp_path / "run.mcap"
    simulate(
        load_scenario("point-obstacle"), uplink="loss:100%", downlink="none", record_to=path, time_limit=1.0
    )
    with pytest.raises(InputError, match="nothing was driven"):
        read_course(path)


@pytest.mark.parametrize("kind", ["remote", "gamepad", "spacemouse"])
def test_no_hand_steers_in_virtual_time(kind, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(["simulate", "--scenario", "point-obstacle", "--steer", kind]) == 2
    assert "nobody steers in virtual time" in capsys.readouterr().err
