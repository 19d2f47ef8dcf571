"""A recorded run, told again on ROS topics with its own stamps and /clock."""

import queue

import pytest

from farhand.bridges.ros2.cdr.types import Types
from farhand.bridges.ros2.playback import CLOCK, RunPlayback
from farhand.common.link.ports import free_ports
from farhand.common.recording.reader import read_run
from farhand.testing import Programs
from tests.farhand.bridges.ros2.peer import PATIENCE, Peer, router
from tests.farhand.made_run import make_run


class Taker:
    """Remembers what it is told."""

    def __init__(self):
        self.said, self.looked = [], []

    def hand_on(self, packet, now_ns):
        self.said.append((packet.key.rpartition("/")[2], now_ns))

    def look(self, now_ns):
        self.looked.append(now_ns)

    def put(self, message):
        self.said.append(("clock", message.clock.sec * 10**9 + message.clock.nanosec))


@pytest.fixture
def path(tmp_path):
    make_run(tmp_path / "made.mcap", ticks=60)
    return tmp_path / "made.mcap"


def test_ticks_are_told_when_they_are_due_and_with_the_stamps_of_the_run(path):
    run, taker = read_run(path), Taker()
    playback = RunPlayback(iter(run.ticks), run.info, taker, taker, Types("jazzy"), 2.0)
    begun, first, third = 10**15, run.ticks[0].now_ns, run.ticks[2].now_ns
    assert playback.step(begun) == begun + (run.ticks[1].now_ns - first) // 2
    playback.step(begun + (third - first) // 2)
    assert taker.looked == [tick.now_ns for tick in run.ticks[:3]]
    told_ns = 0
    for kind, at in taker.said:  # a stamp ahead of /clock is a transform of the future
        told_ns = at if kind == "clock" else told_ns
        assert kind == "clock" or at + run.info.epoch_ns <= told_ns
    clocks = [at for kind, at in taker.said if kind == "clock"]
    assert clocks == [tick.now_ns + run.info.epoch_ns for tick in run.ticks[:3]]
    assert [kind for kind, _ in taker.said].count("report") == 3
    assert not playback.over
    assert playback.step(begun + 10**12) is None
    assert playback.over
    assert {"state", "scene", "description", "report", "command"} <= {kind for kind, _ in taker.said}
    assert run.info.kept is None or run.info.kept >= 0.0


@pytest.mark.realtime
def test_the_program_tells_a_recording_to_an_independent_node(path, tmp_path):
    (port,) = free_ports(1)
    run = read_run(path)
    with router(port), Peer(port) as peer, Programs(tmp_path) as programs:
        clock = peer.listen("/clock", CLOCK)
        status = peer.listen(f"/farhand/{run.info.robot}/status", "moveit_msgs/msg/ServoStatus")
        program = programs.start("ros2", path, "--router", f"tcp/127.0.0.1:{port}", "--speed", "2")
        try:
            first = clock.get(timeout=PATIENCE).clock
            status.get(timeout=PATIENCE)
        except queue.Empty:
            pytest.fail(f"nothing is told: {program.said}")
        stamps = [tick.now_ns + run.info.epoch_ns for tick in run.ticks]
        assert first.sec * 10**9 + first.nanosec in stamps
        assert program.wait() == 0
