import os
import shutil
import signal
import socket
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from farhand.common.link.link import Packet
from farhand.common.link.ports import free_ports
from farhand.common.process.systemd import CountingLink, tell_systemd, watchdog_interval
from farhand.programs.command_line import RobotWords
from farhand.testing import Program, ScriptedLink

ROOT = Path(__file__).resolve().parents[2]
UNITS = sorted((ROOT / "docker/systemd").glob("*.service"))


@pytest.fixture
def systemd(tmp_path):
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as receiver:
        receiver.bind(str(tmp_path / "notify"))
        receiver.settimeout(20.0)
        yield receiver


@pytest.fixture
def stop_event():
    event = threading.Event()
    yield event
    event.set()


def test_without_systemd_the_link_stays_as_it_is(stop_event):
    link = ScriptedLink()
    assert tell_systemd(link, stop_event, {}) is link


def test_ready_after_the_first_step_and_alive_as_long_as_there_are_steps(systemd, stop_event):
    environment = {"NOTIFY_SOCKET": systemd.getsockname(), "WATCHDOG_USEC": "60000"}
    link = tell_systemd(ScriptedLink(), stop_event, environment)
    assert isinstance(link, CountingLink)
    link.receive()
    assert systemd.recv(100) == b"READY=1\nWATCHDOG=1"
    link.receive()
    assert systemd.recv(100) == b"WATCHDOG=1"
    systemd.settimeout(0.2)  # ten intervals
    with pytest.raises(TimeoutError):
        systemd.recv(100)
    link.receive()
    systemd.settimeout(20.0)
    assert systemd.recv(100) == b"WATCHDOG=1"


def test_a_vanished_systemd_disturbs_nobody(tmp_path, stop_event):
    link = tell_systemd(
        ScriptedLink(), stop_event, {"NOTIFY_SOCKET": str(tmp_path / "none"), "WATCHDOG_USEC": "1000"}
    )
    for _ in range(1000):
        assert link.receive() == []
    link.send(Packet("k", b"packet"))


@pytest.mark.parametrize(
    ("environment", "expected"),
    [
        ({}, None),
        ({"WATCHDOG_USEC": "x"}, None),
        ({"WATCHDOG_USEC": "0"}, None),
        ({"WATCHDOG_USEC": "1500000"}, 0.5),
        ({"WATCHDOG_USEC": "1500000", "WATCHDOG_PID": "1"}, None),
        ({"WATCHDOG_USEC": "1500000", "WATCHDOG_PID": str(os.getpid())}, 0.5),
    ],
)
def test_the_watchdog_is_fed_three_times_in_its_patience(environment, expected):
    assert watchdog_interval(environment) == expected


@pytest.mark.realtime
def test_the_robots_program_tells_systemd(systemd):
    settings = {"NOTIFY_SOCKET": systemd.getsockname(), "WATCHDOG_USEC": "300000"}
    place = f"tcp/127.0.0.1:{free_ports(1)[0]}"
    words = RobotWords(scenario="point-obstacle", listen=(place,))
    with Program(*words.words(), environment=settings) as program:
        assert systemd.recv(100) == b"READY=1\nWATCHDOG=1"
        assert systemd.recv(100) == b"WATCHDOG=1"
        program.signal(signal.SIGTERM)
        assert program.wait() == 0


@pytest.mark.skipif(not shutil.which("systemd-analyze"), reason="needs systemd-analyze")
@pytest.mark.parametrize("unit", UNITS, ids=lambda path: path.name)
def test_units_are_well_formed(unit, tmp_path):
    text = unit.read_text().replace("/opt/farhand/bin/farhand", sys.executable)
    (tmp_path / unit.name).write_text(text)
    done = subprocess.run(
        ["systemd-analyze", "verify", "--man=no", str(tmp_path / unit.name)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert unit.name not in done.stderr, done.stderr


@pytest.mark.parametrize("unit", UNITS, ids=lambda path: path.name)
def test_units_settings_and_options_exist(unit):
    from farhand.cli import run

    text = unit.read_text()
    (line,) = [line for line in text.splitlines() if line.startswith("ExecStart=")]
    settings = (unit.parent / unit.name.replace("farhand-", "").replace(".service", ".env")).read_text()
    values = dict(each.split("=", 1) for each in settings.splitlines() if not each.startswith("#"))
    words = line.split()[1:]
    for name, value in values.items():
        words = [word.replace(f"${{{name}}}", value) for word in words]
    assert "$" not in " ".join(words)
    assert run([*words, "--help"]) == 0
    assert "LimitRTPRIO" in text
    assert "Restart=always" in text
