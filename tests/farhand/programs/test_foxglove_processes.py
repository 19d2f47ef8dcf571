"""The real `farhand foxglove` with a viewer: a recording, and an operator's ticks over real Zenoh that fall silent."""

import re

import pytest

from farhand.common.link.link import Packet
from farhand.common.link.ports import free_ports
from farhand.common.link.zenoh_link import open_session
from farhand.common.messages.codec import Decoder
from farhand.common.messages.report import ControlReport
from farhand.common.recording.reader import read_run
from farhand.common.timing.clock import SystemClock
from farhand.operator_side.accounts.tick_history import TickHistory
from farhand.site.tick_server import TickServer
from farhand.testing import Programs
from tests.farhand.foxglove.viewer import PLAY, PLAYING, Viewer
from tests.farhand.made_run import make_run

pytestmark = pytest.mark.realtime


@pytest.fixture
def path(tmp_path):
    make_run(tmp_path / "made.mcap", ticks=60)
    return tmp_path / "made.mcap"


def port_of(line):
    return int(re.search(r"ws://\.\.\.:(\d+)", line).group(1))


def test_a_viewer_plays_a_recording_and_the_program_ends_when_told(path, tmp_path):
    with Programs(tmp_path) as programs:
        program = programs.start("foxglove", path, "--listen", "127.0.0.1:0")
        viewer = Viewer(port_of(program.wait_for("open http", 60)))
        viewer.wait(lambda: "/scene" in {each["topic"] for each in viewer.channels.values()})
        viewer.subscribe()
        viewer.control(PLAY, speed=4.0)
        viewer.wait(lambda: viewer.states and viewer.states[0][0] == PLAYING)
        viewer.wait(lambda: sum(topic == "/scalars" for topic, *_ in viewer.said) > 20)
        viewer.close()
        assert program.interrupt(30) == 0


def test_an_operators_ticks_are_shown_and_its_silence_is_said(path, tmp_path):
    (port,) = free_ports(1)
    run, decode = read_run(path), Decoder(ControlReport).decode
    history, session = TickHistory(), open_session(listen=[f"tcp/127.0.0.1:{port}"])
    server = TickServer(history, run.info, session, SystemClock().now_ns)
    try:
        with Programs(tmp_path) as programs:
            program = programs.start(
                "foxglove", "--connect", f"tcp/127.0.0.1:{port}", "--listen", "127.0.0.1:0"
            )
            viewer = Viewer(port_of(program.wait_for("open http", 60)))
            for tick in run.ticks[:20]:
                packets = [Packet(key=k, payload=p, arrived_ns=at) for k, at, p in tick.packets]
                history.tick(tick.now_ns, packets, tick.command, decode(tick.report))
            program.wait_for("shows run 'made'", 30)
            viewer.wait(lambda: viewer.times)
            assert viewer.times[-1] <= run.ticks[19].now_ns + run.info.epoch_ns
            viewer.wait(lambda: viewer.status)
            program.wait_for("nothing is heard of the operator's program", 30)
            assert viewer.times[-1] == run.ticks[19].now_ns + run.info.epoch_ns
            viewer.close()
            assert program.interrupt(30) == 0
    finally:
        server.close()
        session.close()
