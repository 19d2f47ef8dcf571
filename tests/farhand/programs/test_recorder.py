"""A recorder waits for an operator's program that stalls, and says what is true of one that is gone."""

import threading

import msgspec
import pytest

from farhand.common.messages.codec import encode
from farhand.common.recording.batch import TickBatch
from farhand.common.recording.fates import FATE_TOPICS, Fate, FateBatch
from farhand.common.recording.reader import Entry, RunReader, read_run
from farhand.common.recording.records import RunInfo, TickRecord
from farhand.common.recording.run_file import RunFile
from farhand.programs.following.followed_run import FollowedRun
from farhand.programs.recorder import _conclude, follow
from farhand.testing import report
from farhand.testing.disk import ScriptedFile

INFO = RunInfo(scenario={"name": "x"}, robot="r", session=3, seed=1, versions={})
TICK_NS, KEPT = 100_000_000, 300


class Machine:
    """An operator's program that ticks at 10 Hz, by a clock that the recorder's waiting moves.

    Args:
        stalls: (from, to) in which it does not answer (s).
        ends: when its process says that it ends, or dies (s).
        dies: it says nothing.
        replaced: when another program answers in its place (s).
        told: when the recorder is told to end (s).
    """

    def __init__(self, stalls=(0.0, 0.0), ends=1e9, *, dies=False, replaced=1e9, told=1e9):
        self.now, self.stalls, self.end, self.dies = 0.0, stalls, ends, dies
        self.replaced, self.told = replaced, told

    def now_ns(self):
        return round(self.now * 1e9)

    def wait(self, seconds):
        self.now += seconds

    def is_set(self):
        return self.now >= self.told

    def frames(self):
        return []

    def fates(self, since):
        return None

    def connected(self):
        return self.now < self.end

    def ticks(self, since, written):
        gone = self.dies and self.now >= self.end
        if gone or self.stalls[0] <= self.now < self.stalls[1]:
            self.now += 0.0 if gone else 1.0
            return None
        count = int(min(self.now, self.end) * 10) + 1
        info = msgspec.structs.replace(INFO, session=3 + (self.now >= self.replaced))
        first = max(since, count - KEPT)
        ticks = tuple(TickRecord(n, n * TICK_NS, (), None, encode(report(n))) for n in range(first, count))
        return TickBatch(info=info, ticks=ticks, more=False, ended=self.now >= self.end)


def recorded(machine, tmp_path, capsys, monkeypatch):
    """Exit code, number of ticks and what was said."""
    monkeypatch.setattr(threading, "Event", lambda: machine)
    recording = FollowedRun(lambda info: RunFile(None, info, file=ScriptedFile()))
    why = follow(recording, machine, machine, machine, machine)
    monkeypatch.undo()
    code = _conclude(recording, tmp_path / "run.mcap", why)
    recording.close()
    return code, recording.next - recording.file.missing, capsys.readouterr().err


@pytest.mark.parametrize("stall", [4.0, 25.0])
def test_it_waits_for_a_program_that_stalls_and_has_all_ticks(stall, tmp_path, capsys, monkeypatch):
    machine = Machine(stalls=(5.0, 5.0 + stall), ends=40.0)
    code, ticks, said = recorded(machine, tmp_path, capsys, monkeypatch)
    assert (code, ticks) == (0, 401), said
    assert ("does not answer for 5 s" in said) == ("answers again" in said) == (stall > 5.0)


def test_a_stall_longer_than_memory_is_a_gap_that_is_told(tmp_path, capsys, monkeypatch):
    machine = Machine(stalls=(5.0, 65.0), ends=80.0)
    code, ticks, said = recorded(machine, tmp_path, capsys, monkeypatch)
    assert code == 1
    assert 400 < ticks < 801 - 250
    assert "ticks are missing: the operator's program keeps them no more" in said.splitlines()[-1]


@pytest.mark.parametrize(
    ("machine", "why", "after"),
    [
        (Machine(ends=5.05, dies=True), "no word of it for 30 s", 30.0),
        (Machine(replaced=5.05), "is another one now, with a run of its own", 0.0),
        (Machine(ends=5.05, dies=True, told=6.0), "does not answer any more", 0.0),
    ],
)
def test_one_that_is_gone_is_told_with_the_tick_after_which_nothing_is_known(
    machine, why, after, tmp_path, capsys, monkeypatch
):
    code, ticks, said = recorded(machine, tmp_path, capsys, monkeypatch)
    assert code == 1
    last = said.splitlines()[-1]
    assert why in last
    assert f"after tick {ticks - 1}, if anything was, is not there" in last
    assert machine.now >= 5.0 + after


def test_on_a_full_disk_it_says_how_many_ticks_and_messages_are_in_the_file(tmp_path, capsys):
    disk = ScriptedFile()
    recording = FollowedRun(lambda info: RunFile(None, info, file=disk))
    recording.take(Machine().ticks(0, None))  # one tick
    disk.fails = lambda number: number > 30
    machine = Machine(ends=12.0)
    for second in range(1, 13):
        machine.now = second
        recording.take(machine.ticks(recording.next, None))
        fates = tuple(fate(number) for number in range(recording.next_fate, 10 * second))
        recording.take_fates(
            FateBatch(
                session=1,
                first=recording.next_fate,
                fates=fates,
                more=False,
                epoch_ns=1,
                uplink="",
                downlink="",
                seed=1,
                sessions_ns={INFO.session: 0},
            )
        )
    recording.close()
    assert _conclude(recording, tmp_path / "run.mcap", "") == 1
    found, missing = len(read_run(disk).ticks), 121 - len(read_run(disk).ticks)
    entries = sum(isinstance(item, Entry) for item in RunReader(disk).items(FATE_TOPICS["uplink"].__eq__))
    assert 0 < found < 121
    assert 0 < entries < 120
    said = capsys.readouterr().err.splitlines()
    assert said[0] == f"record: {found} ticks, what became of {entries} messages in {tmp_path / 'run.mcap'}"
    assert f"what became of {120 - entries} messages is missing" in said[1]
    assert f"{missing} ticks are missing: it cannot be written" in said[2]


def fate(number):
    return Fate(
        direction="uplink",
        key="farhand/r/command",
        number=number,
        size=1,
        arrived_ns=number * TICK_NS,
        drawn_ns=0,
        assigned_ns=0,
        achieved_ns=0,
    )


def test_told_to_end_while_all_is_well_nothing_is_missing(tmp_path, capsys, monkeypatch):
    code, ticks, said = recorded(Machine(told=3.0), tmp_path, capsys, monkeypatch)
    assert (code, "missing" in said, "not there" in said) == (0, False, False)
    assert ticks >= 30
