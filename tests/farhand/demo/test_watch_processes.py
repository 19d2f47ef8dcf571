"""What a screen says after a kill -9 of operator, network or robot: within seconds, who is gone, and nothing live."""

import io
import re
import signal
import threading

import pytest
from rich.console import Console

from farhand.common.link.ports import free_ports
from farhand.common.timing.clock import SystemClock
from farhand.demo.live_status import StatusView
from farhand.demo.report_reader import ReportReader
from farhand.testing import Programs, short_task
from tests.examples import also

pytestmark = pytest.mark.realtime
PATIENCE = 40.0
ENDED = "the operator ended before the last target: it gave control up"
FAR = [(50.0, 0.0, 0.5)]  # a task that does not end meanwhile


class Screen:
    """What somebody sees at a terminal, drawn until something is on it."""

    def __init__(self, endpoint):
        self._clock, self._pause = SystemClock(), threading.Event()
        self._reader = ReportReader(endpoint, "r", self._clock)
        self._file = io.StringIO()
        self._view = StatusView("r", Console(file=self._file, force_terminal=True, width=80))
        self._view.__enter__()

    def wait_for(self, text):
        """The first screen with this text on it; how long that took (s), and the screen with its codes."""
        start_ns = self._clock.now_ns()
        while True:
            self._file.seek(0)
            self._file.truncate()
            reports, now_ns = self._reader.read(), self._clock.now_ns()
            self._view.update(reports, now_ns, self._reader.connected(), self._reader.released)
            codes, waited = self._file.getvalue(), (self._clock.now_ns() - start_ns) * 1e-9
            if text in re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", codes):
                return waited, codes
            assert waited < PATIENCE, codes
            self._pause.wait(0.05)

    def close(self):
        self._view.__exit__()
        self._reader.close()


@pytest.mark.parametrize(
    "ends",
    [
        [(["operator"], signal.SIGKILL, "OPERATOR GONE")],
        [(["netem"], signal.SIGKILL, "ROBOT AND NETWORK GONE"), (["operator"], signal.SIGTERM, ENDED)],
        also([(["robot"], signal.SIGKILL, "ROBOT GONE")]),
        also([(["operator", "netem", "robot"], signal.SIGKILL, "OPERATOR GONE")]),
        also([(["operator"], signal.SIGTERM, ENDED)]),
    ],
)
def test_within_seconds_of_an_end_the_screen_says_who_is_gone(ends, tmp_path):
    up, down, reports = (f"tcp/127.0.0.1:{port}" for port in free_ports(3))
    scenario = short_task(tmp_path, FAR)
    screen = Screen(reports)
    try:
        with Programs() as programs:
            screen.wait_for("waiting for the operator")
            task = ("--scenario", scenario, "--robot", "r")
            started = {
                "netem": programs.start("netem", "--listen-operator", up, "--listen-robot", down),
                "robot": programs.start("robot", *task, "--connect", down),
                "operator": programs.start("operator", *task, "--connect", up, "--report", reports),
            }
            _, codes = screen.wait_for(" RUN ")
            assert ";42m" in codes
            for victims, number, said in ends:
                for name in victims:
                    started[name].signal(number)
                waited, codes = screen.wait_for(said)
                assert (2.5 if number == signal.SIGKILL else 0.9) < waited < 8.0
                assert ";42m" not in codes
                assert "RUN" not in codes
                assert "clock stands" in codes
    finally:
        screen.close()
