"""What a viewer gets over a real socket: of a recording with play, pause and seek, and of a running operator."""

import base64
import threading

import msgspec
import pytest

from farhand.common.recording.batch import TickBatch
from farhand.common.recording.reader import read_run
from farhand.common.timing.clock import to_ns
from farhand.foxglove.playback import Playback
from farhand.foxglove.player import Player
from farhand.foxglove.recorded_topics import RecordedTopics
from farhand.foxglove.server import Listener, Server
from farhand.programs.foxglove import SILENT_AFTER_NS, Live
from tests.farhand.foxglove.viewer import ENDED, PAUSE, PAUSED, PLAY, PLAYING, Viewer
from tests.farhand.made_run import make_run

HOST = "127.0.0.1"


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("made") / "made.mcap"
    make_run(path)
    return path


def shown(specs):
    """As a viewer sees channels of a file."""
    return {
        (
            each.topic,
            each.encoding,
            each.schema,
            each.schema_encoding,
            base64.b64encode(each.schema_data).decode()
            if each.encoding == "protobuf"
            else each.schema_data.decode(),
        )
        for each in specs
    }


class Played:
    """A playback whose time the test makes pass."""

    def __init__(self, path):
        self.topics = RecordedTopics(path)
        self.player = Player(self.topics, lambda *each: self.channels.add(*each))
        self.playback = Playback(self.player, self.topics.start_ns, self.topics.end_ns)
        self.server = Server(
            "made",
            HOST,
            0,
            Listener(self.playback.subscribed, self.playback.control),
            (self.topics.start_ns, self.topics.end_ns),
        )
        self.channels = self.server.channels(self.topics.specs)
        self.viewer = Viewer(self.server.port)
        self.viewer.wait(lambda: len(self.viewer.channels) == len(self.topics.specs))
        self.now_ns = 0

    def pass_time(self, seconds):
        for _ in range(round(seconds / 0.05)):
            self.now_ns += to_ns(0.05)
            changed = self.playback.go_on(self.now_ns)
            if changed is not None:
                self.server.state(changed)
        self.server.time(self.playback.shown_ns)

    def asked(self, *words, **more):
        """Ask, and wait for the answer."""
        states = len(self.viewer.states)
        self.viewer.control(*words, **more)
        self.viewer.wait(lambda: len(self.viewer.states) > states)
        return self.viewer.states[-1]

    def close(self):
        self.viewer.close()
        self.server.close()
        self.topics.close()


@pytest.fixture
def played(path):
    one = Played(path)
    yield one
    one.close()


def test_a_viewer_plays_pauses_and_seeks_a_recording(played):
    viewer, topics = played.viewer, played.topics
    start_ns = topics.start_ns
    assert viewer.info["dataStartTime"] == {"sec": start_ns // 10**9, "nsec": start_ns % 10**9}
    assert "playbackControl" in viewer.info["capabilities"]
    assert viewer.topics() == shown(topics.specs)
    viewer.subscribe()
    assert played.asked(PLAY) == (PLAYING, start_ns, 1.0, False, "r")
    played.pass_time(3.0)
    middle_ns = played.playback.shown_ns
    assert middle_ns - start_ns == pytest.approx(to_ns(3.0), abs=to_ns(0.11))
    viewer.wait(lambda: viewer.times and viewer.times[-1] == middle_ns)
    viewer.wait(lambda: sum(topic == "/operator/report" for topic, *_ in viewer.said) >= 28)
    assert max(at for _, at, _ in viewer.said) <= middle_ns
    assert played.asked(PAUSE, request="p") == (PAUSED, middle_ns, 1.0, False, "p")
    viewer.rest()
    viewer.said.clear()
    played.pass_time(2.0)
    viewer.rest()
    assert not viewer.said
    seek_ns = start_ns + to_ns(8.0)
    assert played.asked(PAUSE, seek_ns=seek_ns, request="s") == (PAUSED, seek_ns, 1.0, True, "s")
    played.pass_time(0.05)
    viewer.wait(lambda: viewer.heard() >= {"/scene", "/tf", "/scalars", "/plan", "/robot/scene"})
    viewer.rest()
    assert max(at for _, at, _ in viewer.said) <= seek_ns
    played.asked(PLAY, speed=4.0)
    played.pass_time(2.0)
    viewer.wait(lambda: viewer.states[-1][0] == ENDED)
    assert viewer.states[-1][1] == topics.end_ns
    assert not played.playback.playing


def test_a_viewer_that_comes_later_gets_what_stands(played):
    played.viewer.subscribe()
    played.asked(PAUSE, seek_ns=played.topics.start_ns + to_ns(5.0))
    played.pass_time(0.05)
    late = Viewer(played.server.port)
    late.wait(lambda: len(late.channels) == len(played.topics.specs))
    played.playback.asked.clear()
    late.subscribe()
    assert played.playback.asked.wait(20)
    for _ in range(100):  # each topic is subscribed to by itself
        played.pass_time(0.05)
        late.rest(0.1)
        if "/scene" in late.heard():
            break
    assert "/scene" in late.heard()
    late.close()


class Given:
    """Sources that give what the test says."""

    def __init__(self, run):
        self.run = run.info, run.ticks
        self.answers, self.upto, self.ended = True, 0, False

    def ticks(self, since):
        if not self.answers:
            return None
        info, recorded = self.run
        ticks = tuple(each for each in recorded[: self.upto] if each.number >= since)
        return TickBatch(info=info, ticks=ticks, more=False, ended=self.ended)

    def fates(self, since):
        return None


def subscribe(viewer):
    """To everything, and wait until the server has heard it."""
    viewer.subscribe()
    for _ in range(100):
        viewer.rest(0.1)
        if len(viewer.looks) == len(viewer.channels):
            return
    raise AssertionError(f"subscribed to {len(viewer.looks)} of {len(viewer.channels)}")


@pytest.fixture
def live(path):
    again, looks = threading.Event(), []
    server = Server("live", HOST, 0, Listener(lambda: (looks.append(1), again.set())))
    given = Given(read_run(path))
    viewer = Viewer(server.port)
    viewer.looks = looks
    yield Live(server, given, again), given, viewer
    viewer.close()
    server.close()


def test_a_running_operator_has_the_topics_of_its_recording_and_the_same_messages(live, path):
    program, given, viewer = live
    topics = RecordedTopics(path)
    given.upto = 1
    program.step(0)
    viewer.wait(lambda: len(viewer.channels) == len(topics.specs))
    assert viewer.topics() == shown(topics.specs)
    subscribe(viewer)
    written = []
    player = Player(
        topics, lambda channel, at, data: written.append((topics.specs[channel - 1].topic, at, data))
    )
    player.seek(topics.start_ns)
    player.advance(topics.end_ns)
    for upto in range(2, 40):
        given.upto = upto
        program.step(upto * 10**8)
    last_ns = given.run[1][38].now_ns + given.run[0].epoch_ns
    viewer.wait(lambda: viewer.times and viewer.times[-1] == last_ns)
    viewer.wait(lambda: ("/scalars", last_ns) in {each[:2] for each in viewer.said})
    first_ns = given.run[1][1].now_ns + given.run[0].epoch_ns
    for topic in ("/operator/report", "/scalars", "/robot/state", "/scene", "/farhand/tick"):
        sent = [(at, data) for name, at, data in viewer.said if name == topic and first_ns < at <= last_ns]
        kept = [(at, data) for name, at, data in written if name == topic and first_ns < at <= last_ns]
        assert sorted(sent) == sorted(kept)
        assert sent
    topics.close()


def test_an_operator_that_is_silent_does_not_look_alive(live, capsys):
    program, given, viewer = live
    given.upto = 10
    program.step(0)
    viewer.wait(lambda: viewer.times)
    shown_ns = viewer.times[-1]
    given.answers = False
    for step in range(1, 6):
        program.step(step * SILENT_AFTER_NS // 4)
    viewer.wait(lambda: viewer.status)
    assert viewer.status["run"] == "nothing is heard of the operator's program; what is shown is old"
    viewer.rest()
    assert viewer.times[-1] == shown_ns
    late = Viewer(int(program._server.port))
    late.wait(lambda: late.channels)
    late.subscribe()
    assert program._again.wait(20)
    program.step(2 * SILENT_AFTER_NS)
    late.wait(lambda: late.status)
    late.close()
    given.answers, given.upto = True, 12
    program.step(2 * SILENT_AFTER_NS)
    viewer.wait(lambda: not viewer.status)
    said = capsys.readouterr().err
    assert said.count("nothing is heard of the operator's program") == 1
    assert said.count("is heard again") == 1


def test_before_an_operator_was_ever_heard_nothing_is_said_to_be_shown(live):
    program, given, viewer = live
    given.answers = False
    for step in range(6):
        program.step(step * SILENT_AFTER_NS // 4)
    viewer.wait(lambda: viewer.status)
    assert viewer.status["run"] == "nothing is heard of the operator's program; nothing is shown yet"


def test_one_that_answers_but_decides_nothing_any_more_is_silent_as_well(live):
    program, given, viewer = live
    given.upto = 10
    for step in range(6):
        program.step(step * SILENT_AFTER_NS // 4)
    viewer.wait(lambda: viewer.status)


def test_an_end_is_said_and_another_program_is_another_run(live):
    program, given, viewer = live
    given.upto, given.ended = 10, True
    program.step(0)
    viewer.wait(lambda: viewer.status)
    assert "has ended" in viewer.status["run"]
    subscribe(viewer)
    given.upto, given.ended = 12, False
    for step in range(1, 40):  # it lingers, and then is gone
        given.answers = step < 5
        program.step(step * 10**8)
    viewer.rest()
    assert "has ended" in viewer.status["run"]
    assert not viewer.said
    given.answers = True
    given.run = msgspec.structs.replace(given.run[0], session=99), given.run[1]
    program.step(50 * 10**8)
    viewer.wait(lambda: not viewer.status)
    viewer.wait(lambda: viewer.said)
