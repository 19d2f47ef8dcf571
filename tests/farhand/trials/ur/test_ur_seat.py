"""From the seat: emulator, robot, netem, operator, console; a page drives; protective stop; recover; drive on."""

import threading

import pytest

from farhand.common.link.ports import free_ports
from farhand.common.timing.clock import SystemClock
from farhand.trials.ur.rig import Rig
from tests.operator_side.console.caller import Caller

pytestmark = [pytest.mark.realtime, pytest.mark.slow]
ADDRESS = "127.0.0.34"
MOVES = 0.02  # rad/s


class Page:
    """A page whose key is held down, or not; it says so fifty times a second."""

    def __init__(self, host):
        self.caller, self.clock = Caller(host), SystemClock()
        self.engaged, self.press = False, 0
        self.over, self.lock = threading.Event(), threading.Lock()
        self.frame = {}
        self.threads = [threading.Thread(target=run, daemon=True) for run in (self._steer, self._hear)]
        for thread in self.threads:
            thread.start()

    def do(self, what):
        with self.lock:
            self.caller.says(kind="do", what=what)

    def hold(self):
        """Press the key, and keep it."""
        self.press += 1
        self.engaged = True

    def let_go(self):
        self.engaged = False

    def close(self):
        self.over.set()
        self.caller.close()
        for thread in self.threads:
            thread.join(5)

    def _steer(self):
        while not self.over.wait(0.02):
            with self.lock:
                self.caller.steer(self.clock.now_ns(), self.engaged, self.press, (0.0, 0.5, 0.0))

    def _hear(self):
        try:
            while not self.over.is_set():
                self.frame = self.caller.hear("frame")
        except Exception:
            return  # it was closed


@pytest.fixture
def rig(tmp_path):
    made = Rig(tmp_path, ADDRESS, driven=False)
    yield made
    made.close()


def speed(rig):
    """Of the fastest joint of the emulated arm (rad/s)."""
    return float(rig.fault("status").partition("fastest joint ")[2].split()[0])


@pytest.mark.long
def test_drive_by_hand_protective_stop_recover_drive_on(rig):
    ports = free_ports(4)
    near, far, report = (f"tcp/127.0.0.1:{port}" for port in ports[:3])
    host = f"127.0.0.1:{ports[3]}"
    rig.start_beside(
        "netem", "netem", "--network", "5g-urban", "--listen-operator", near, "--listen-robot", far
    )
    rig.endpoint = far
    rig.start_robot(connects=True)
    rig.start_beside(
        "operator", "operator", "--robot", "ur", "--steer", "remote", "--connect", near, "--report", report
    )
    rig.start_beside("console", "console", "--robot", "ur", "--connect", report, "--listen", host)
    page = Page(host)
    try:
        page.do("take")
        drives(rig, page)
        rig.fault("protective-stop")
        rig.wait_for_stand()
        page.let_go()
        page.do("acknowledge")  # in vain, and no less so once it can be driven again
        rig.pause(0.5)
        assert rig.farhand("ur", "recover", "--host", ADDRESS, "--yes") == 0
        rig.wait(lambda: "program PLAYING" in rig.fault("status"), "Farhand's program to run again")
        page.hold()
        before = rig.joints()
        rig.pause(0.7)
        assert rig.joints() == pytest.approx(before, abs=1e-4)
        drives(rig, page)
    finally:
        page.close()


def drives(rig, page):
    """Acknowledge and press anew until the arm moves, as a person would."""

    def moves():
        page.let_go()
        page.do("acknowledge")
        rig.pause(0.5)
        page.hold()
        rig.pause(0.7)
        return speed(rig) > MOVES

    rig.wait(moves, "the arm to move")
