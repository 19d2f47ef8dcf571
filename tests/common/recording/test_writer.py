"""What the recorder does when the disk is slow, full or broken: the run goes on, and the file tells."""

import threading

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.common.errors import RunFileError
from farhand.common.recording.reader import read_run
from farhand.common.recording.records import RunInfo
from farhand.common.recording.writer import TOO_SLOW, RunRecorder
from farhand.testing import report
from farhand.testing.disk import ScriptedFile

INFO = RunInfo(scenario={"name": "x"}, robot="r", session=3, seed=1, versions={"python": "3"})


def feed(recorder, count):
    for tick in range(count):
        recorder.tick(tick * 100, [], b"c%d" % tick, report(tick))


def check_all_is_told(run, count):
    """Ticks and gaps make up the whole run."""
    told = {tick.now_ns // 100 for tick in run.ticks}
    for gap in run.gaps:
        missing = set(range(gap.first_ns // 100, gap.last_ns // 100 + 1))
        assert len(missing) == gap.ticks
        assert not missing & told
        assert gap.before == sum(tick.now_ns < gap.first_ns for tick in run.ticks)
        told |= missing
    assert told == set(range(count))
    assert run.missing + len(run.ticks) == count


def test_a_sound_disk_leaves_no_gap():
    disk = ScriptedFile()
    recorder = RunRecorder(None, INFO, file=disk)
    feed(recorder, 50)
    recorder.close()
    run = read_run(disk)
    assert run.complete
    assert len(run.ticks) == 50
    assert (recorder.missing, recorder.trouble, recorder.troubles()) == (0, "", {})
    assert disk.threads == {"recorder", threading.current_thread().name}  # the beginning and the end


@settings(max_examples=40, deadline=None)
@given(st.sets(st.integers(2, 200), max_size=60))
def test_writes_that_fail_leave_gaps_that_are_told(failing):
    disk = ScriptedFile()
    recorder = RunRecorder(None, INFO, file=disk)
    disk.fails = lambda number: number - started in failing
    started = disk.writes
    feed(recorder, 40)
    recorder._ticks.close()
    disk.fails = lambda number: False  # there is place again at the end
    recorder.close()
    run = read_run(disk)
    assert not run.cut_off
    check_all_is_told(run, 40)
    assert recorder.missing == run.missing
    assert run.complete == (run.missing == 0)
    if run.missing:
        assert "No space left on device" in recorder.troubles()["recording"]
        assert all("No space left" in line for line in run.flaws())


def test_a_disk_that_stays_full_ends_the_file_and_not_the_program():
    disk = ScriptedFile()
    recorder = RunRecorder(None, INFO, file=disk)
    feed(recorder, 3)
    while recorder._sequence < 3:
        threading.Event().wait(0.001)
    disk.fails = lambda number: True
    feed(recorder, 5)
    recorder.close()
    assert recorder.missing == 5
    run = read_run(disk)
    assert run.cut_off
    assert len(run.ticks) == 3


@pytest.mark.parametrize("more", [0, 20])
def test_a_disk_that_is_too_slow_leaves_a_gap(more):
    held = threading.Event()
    disk = ScriptedFile()
    recorder = RunRecorder(None, INFO, limit=4, file=disk)
    disk.held = held
    feed(recorder, 30)  # the loop does not wait for the disk, or this would hang
    assert recorder.missing >= 30 - 5
    held.set()
    for tick in range(30, 30 + more):
        while recorder._ticks._queue.qsize():
            threading.Event().wait(0.001)
        recorder.tick(tick * 100, [], None, report(tick))
    recorder.close()
    run = read_run(disk)
    check_all_is_told(run, 30 + more)
    assert [gap.why for gap in run.gaps] == [TOO_SLOW]
    assert not run.complete
    assert not run.cut_off
    assert run.whole_ticks == run.gaps[0].before == 30 - run.missing


def test_virtual_time_waits_for_the_disk():
    disk = ScriptedFile()
    recorder = RunRecorder(None, INFO, waits=True, limit=2, file=disk)
    feed(recorder, 200)
    recorder.close()
    assert read_run(disk).complete
    assert len(read_run(disk).ticks) == 200


def test_a_file_that_cannot_be_begun_is_one_line():
    with pytest.raises(RunFileError, match="cannot be written: No space left"):
        RunRecorder("run.mcap", INFO, file=ScriptedFile(lambda number: True))
