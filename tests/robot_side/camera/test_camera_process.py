"""`farhand camera` as a program: through the emulator to an operator's program and on to its consoles."""

import os
import signal
import threading

import pytest
import simplejpeg

from farhand.common.link.ports import free_ports
from farhand.common.link.zenoh_link import open_session
from farhand.common.messages.camera import CameraFrame
from farhand.common.messages.codec import Decoder
from farhand.common.messages.keys import mirror_key
from farhand.programs.command_line import CameraWords, NetemWords, OperatorWords, RobotWords
from farhand.robot_side.camera.strip import read_strip
from farhand.testing import Programs, Witness, short_task
from farhand.testing.programs import PATIENCE

pytestmark = pytest.mark.realtime


class Pictures:
    """What a console would get."""

    def __init__(self, endpoint):
        self.session, self.frames = open_session([endpoint]), []
        self._changed, self._decoder = threading.Condition(), Decoder(CameraFrame)
        self._subscriber = self.session.declare_subscriber(mirror_key("r", "camera"), self._take)

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


def test_pictures_come_over_the_network_stop_with_the_robot_and_cost_the_robot_nothing(tmp_path):
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
        pictures, robots = Pictures(report), Witness(beside)
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
