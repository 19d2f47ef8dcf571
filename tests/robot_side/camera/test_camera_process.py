"""`farhand camera` as a program: through the emulator to an operator's program and on to its consoles."""

import os
import re
import signal
import threading
from pathlib import Path

import pytest
import simplejpeg

from farhand.common.link.ports import free_ports
from farhand.common.link.zenoh_link import open_session
from farhand.common.messages.camera import CameraFrame
from farhand.common.messages.codec import Decoder
from farhand.common.messages.keys import camera_key, mirror_key
from farhand.programs.command_line import CameraWords, NetemWords, OperatorWords, RobotWords
from farhand.robot_side.camera.strip import read_strip
from farhand.testing import Programs, Witness, short_task
from farhand.testing.programs import PATIENCE

pytestmark = pytest.mark.realtime
PAGE = Path(__file__).resolve().parents[3] / "docs" / "camera.md"


class Pictures:
    """What a console would get."""

    def __init__(self, session, key):
        self.session, self.frames = session, []
        self._changed, self._decoder = threading.Condition(), Decoder(CameraFrame)
        self._subscriber = session.declare_subscriber(key, self._take)

    def _take(self, sample):
        with self._changed:
            self.frames.append(self._decoder.decode_or_raise(sample.payload.to_bytes()))
            self._changed.notify_all()

    def wait_for(self, count):
        """So many more."""
        with self._changed:
            wanted = len(self.frames) + count
            assert self._changed.wait_for(lambda: len(self.frames) >= wanted, PATIENCE), len(self.frames)
            return self.frames[-count:]


def test_pictures_come_over_the_network_stop_with_the_robot_and_leave_it_alone(tmp_path):
    near, far, beside, report = (f"tcp/127.0.0.1:{port}" for port in free_ports(4))
    scenario = str(short_task(tmp_path))
    with Programs(tmp_path) as programs:
        start = lambda words: programs.start(*words.words())  # noqa: E731
        start(
            NetemWords(
                listen_operator=near, listen_robot=far, network="rate:2mbit", stats=str(tmp_path / "n.json")
            )
        )
        robot = start(RobotWords(scenario=scenario, robot="r", connect=(far,), listen=(beside,)))
        camera = start(
            CameraWords(scenario=scenario, robot="r", connect=(beside, far), size="160x120", rate=20.0)
        )
        start(OperatorWords(scenario=scenario, robot="r", connect=(near,), report=report))
        camera.wait_for("160x120 at 20 Hz")
        pictures, robots = Pictures(open_session([report]), mirror_key("r", "camera")), Witness(beside)
        try:
            found = pictures.wait_for(20)
            numbers = [each.seq for each in found]
            assert numbers == sorted(set(numbers))  # each once, in order
            stamps = {(each.session, each.t_sample_ns) for each in robots.states}
            for each in found:
                assert read_strip(simplejpeg.decode_jpeg(each.jpeg)) == each.t_captured_ns
            newest = pictures.wait_for(1)[0]
            robots.wait_until(lambda s: s.t_sample_ns > newest.t_captured_ns)
            stamps = {(each.session, each.t_sample_ns) for each in robots.states}
            assert (newest.robot_session, newest.t_captured_ns) in stamps  # it shows a state that was
            os.kill(robot.pid, signal.SIGSTOP)
            camera.wait_for("no picture is sent: no new state comes from the robot")
            os.kill(robot.pid, signal.SIGCONT)
            camera.wait_for("sends pictures again")
            pictures.wait_for(5)
            os.kill(camera.pid, signal.SIGKILL)  # whatever becomes of the camera, the robot says its states
            robots.wait_until(lambda s: True)
            assert robot.alive
        finally:
            robots.close()
            pictures.session.close()


def test_any_program_may_publish_pictures_as_the_page_shows():
    endpoint = f"tcp/127.0.0.1:{free_ports(1)[0]}"
    pictures = Pictures(open_session(listen=[endpoint]), camera_key("ur5"))
    code = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)[0]
    publisher = threading.Thread(
        target=exec, args=(code.replace("tcp/127.0.0.1:7448", endpoint), {}), daemon=True
    )
    publisher.start()
    found = pictures.wait_for(1)[0]
    assert (found.camera, found.robot_session, found.source) == ("mine", 0, "ur5")
    assert simplejpeg.decode_jpeg(found.jpeg).shape == (240, 320, 3)
    publisher.join(PATIENCE)
    pictures.session.close()
