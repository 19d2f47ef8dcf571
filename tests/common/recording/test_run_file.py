"""What the file of a run tells when the disk is full or broken: the run goes on, and what is missing is said."""

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.common.errors import RunFileError
from farhand.common.messages.codec import encode
from farhand.common.recording.reader import read_run
from farhand.common.recording.records import RunInfo, TickRecord
from farhand.common.recording.run_file import CHUNK_NS, RunFile
from farhand.testing import report
from farhand.testing.disk import ScriptedFile

INFO = RunInfo(scenario={"name": "x"}, robot="r", session=3, seed=1, versions={"python": "3"})
STEP_NS = CHUNK_NS // 2


def feed(file, count):
    for number in range(count):
        file.tick(TickRecord(number, number * STEP_NS, (), b"c%d" % number, encode(report(number))))


def check_all_is_told(run, count):
    """Ticks and gaps make up the whole run."""
    told = {tick.number for tick in run.ticks}
    for gap in run.gaps:
        missing = set(range(gap.first_ns // STEP_NS, gap.last_ns // STEP_NS + 1))
        assert len(missing) == gap.ticks
        assert not missing & told
        assert gap.before == sum(tick.now_ns < gap.first_ns for tick in run.ticks)
        told |= missing
    assert told == set(range(count))
    assert run.missing + len(run.ticks) == count


def test_a_sound_disk_leaves_no_gap():
    disk = ScriptedFile()
    file = RunFile(None, INFO, file=disk)
    feed(file, 50)
    file.close()
    run = read_run(disk)
    assert run.complete
    assert [tick.number for tick in run.ticks] == list(range(50))
    assert (file.missing, file.trouble) == (0, "")


@settings(max_examples=40, deadline=None)
@given(st.sets(st.integers(2, 60), max_size=30))
def test_writes_that_fail_leave_gaps_that_are_told(failing):
    disk = ScriptedFile()
    file = RunFile(None, INFO, file=disk)
    started = disk.writes
    disk.fails = lambda number: number - started in failing
    feed(file, 40)
    file.flush()
    disk.fails = lambda number: False  # there is place again at the end
    file.close()
    run = read_run(disk)
    assert not run.cut_off
    check_all_is_told(run, 40)
    assert file.missing == run.missing
    assert run.complete == (run.missing == 0)
    if run.missing:
        assert "No space left on device" in file.trouble
        assert all("No space left" in line for line in run.flaws())


def test_a_disk_that_stays_full_ends_the_file_and_not_the_program():
    disk = ScriptedFile()
    file = RunFile(None, INFO, file=disk)
    feed(file, 3)
    disk.fails = lambda number: True
    for number in range(3, 8):
        file.tick(TickRecord(number, number * STEP_NS, (), None, encode(report(number))))
    file.close()
    assert file.missing == 5
    run = read_run(disk)
    assert run.cut_off
    assert len(run.ticks) == 3


def test_a_file_that_cannot_be_begun_is_one_line():
    with pytest.raises(RunFileError, match="cannot be written: No space left"):
        RunFile("run.mcap", INFO, file=ScriptedFile(lambda number: True))


def test_a_recording_that_began_later_says_so():
    disk = ScriptedFile()
    file = RunFile(None, msgspec.structs.replace(INFO, first_tick=7), file=disk)
    file.tick(TickRecord(7, 0, (), None, encode(report(7))))
    file.close()
    run = read_run(disk)
    assert not run.complete
    assert run.whole_ticks == 0
    assert run.flaws() == ["recording began with tick 7 of the run"]


@settings(max_examples=80, deadline=None)
@given(st.data())
def test_a_flipped_bit_costs_a_chunk_at_most_or_what_is_after_it_and_is_told(data):
    disk = ScriptedFile()
    file = RunFile(None, INFO, file=disk)
    feed(file, 12)
    file.close()
    whole = read_run(disk)
    at = data.draw(st.integers(0, len(disk.data) - 1))
    disk.data[at] ^= 1 << data.draw(st.integers(0, 7))
    refused = ""
    try:
        run = read_run(disk)
    except RunFileError as found:
        refused = str(found)
    if refused:
        assert "\n" not in refused
        return
    assert run.info == whole.info
    by_number = {tick.number: tick for tick in whole.ticks}
    assert all(by_number[tick.number] == tick for tick in run.ticks)
    assert len(run.ticks) == 12 or not run.complete
