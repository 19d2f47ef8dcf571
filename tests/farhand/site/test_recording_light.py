"""The light that says that a run is recorded: lit by what is in a file alone, out by itself when that stops growing."""

import msgspec
import pytest

from farhand.common.recording.batch import TicksWanted
from farhand.common.recording.records import RunInfo
from farhand.common.recording.run_file import RunFile
from farhand.operator_side.accounts.tick_history import TickHistory
from farhand.programs.following.followed_run import FollowedRun
from farhand.site.tick_server import CONFIRMED_NS, TickServer
from farhand.testing import report
from farhand.testing.disk import ScriptedFile
from tests.farhand.site.fakes import Silent

INFO = RunInfo(scenario={"name": "x"}, robot="r", session=3, seed=1, versions={"python": "3"})
ASKS_NS, TICK_NS = 200_000_000, 100_000_000


class Program:
    """An operator's program that ticks, and a recorder that asks it five times a second."""

    def __init__(self):
        self.now_ns, self.count = 0, 0
        self.history, self.disk = TickHistory(), ScriptedFile()
        self.server = TickServer(self.history, INFO, Silent(), lambda: self.now_ns)
        self.recording = FollowedRun(lambda info: RunFile(None, info, file=self.disk))

    def runs(self, seconds, *, asks=True, writes=True):
        for _ in range(round(seconds * 1e9 / ASKS_NS)):
            for _ in range(ASKS_NS // TICK_NS):
                self.history.tick(self.now_ns, [], None, report(self.count))
                self.count += 1
            self.now_ns += ASKS_NS
            if asks:
                wanted = TicksWanted(
                    since=self.recording.next, written=self.recording.written if writes else None
                )
                self.recording.take(self.server.answer(msgspec.json.encode(wanted)))
        return self.server.recording(self.now_ns)


@pytest.fixture
def program():
    made = Program()
    yield made
    made.server.close()


def test_it_is_not_there_before_anything_is_in_a_file(program):
    assert program.runs(1.0, asks=False) is msgspec.UNSET
    assert program.runs(0.2) is msgspec.UNSET  # the first has been given, nobody has said that it is written
    assert program.runs(0.2) is True


def test_a_viewer_lights_nothing(program):
    assert program.runs(3.0, writes=False) is msgspec.UNSET


def test_it_goes_out_by_itself_when_the_recorder_is_dead_and_on_when_it_is_back(program):
    assert program.runs(1.0) is True
    assert program.runs(CONFIRMED_NS * 1e-9 + 0.2, asks=False) is False
    assert program.runs(0.6) is True


def test_a_full_disk_puts_it_out_though_the_recorder_lives(program):
    assert program.runs(1.0) is True
    program.disk.fails = lambda number: True
    assert program.runs(CONFIRMED_NS * 1e-9 + 0.4) is False
    program.disk.fails = lambda number: False
    assert program.runs(0.6) is True
