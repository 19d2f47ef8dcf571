"""Recordings: what was written is read, and what was cut off is read up to the cut."""

import io

import msgspec
import pytest

from farhand.common.errors import RunFileError
from farhand.common.link.link import Packet
from farhand.common.messages.codec import Decoder
from farhand.common.messages.report import ControlReport
from farhand.common.recording.reader import read_run
from farhand.common.recording.records import FORMAT, RunInfo
from farhand.common.recording.writer import RunRecorder
from farhand.laboratory.simulation import simulate
from farhand.testing import report
from tests.examples import THOROUGH

INFO = RunInfo(scenario={"name": "x"}, robot="r", session=3, seed=1, versions={"python": "3"})


class InMemory:
    """In place of a path: thousands of files on disk would take long."""

    def __init__(self, data):
        self.data = data

    def open(self, mode):
        return io.BytesIO(self.data)


@pytest.fixture
def recording(tmp_path):
    path = tmp_path / "run.mcap"
    recorder = RunRecorder(path, INFO)
    for tick in range(5):
        packets = [Packet("farhand/r/state", bytes([tick]) * tick, 10 * tick)]
        recorder.tick(tick * 100, packets, None if tick == 0 else b"command%d" % tick, report(tick))
    recorder.close()
    return path


def test_what_was_written_is_read(recording):
    run = read_run(recording)
    assert run.complete
    assert run.info == INFO
    assert run.size == recording.stat().st_size
    assert [t.now_ns for t in run.ticks] == [0, 100, 200, 300, 400]
    assert run.ticks[0].command is None
    assert run.ticks[3].command == b"command3"
    assert run.ticks[3].packets == (("farhand/r/state", 30, b"\x03\x03\x03"),)
    assert [Decoder(ControlReport).decode_or_raise(t.report) for t in run.ticks] == list(
        map(report, range(5))
    )


@pytest.mark.thorough
def test_cut_off_at_any_length_the_whole_ticks_before_the_cut_are_there(recording):
    whole, data = read_run(recording), recording.read_bytes()
    readable, before = 0, -1
    lengths = range(0, len(data), 1 if THOROUGH else 11)
    for length in lengths:
        try:
            run = read_run(InMemory(data[:length]))
        except RunFileError:
            assert readable == 0, length
            continue
        readable += 1
        assert not run.complete, length
        assert run.ticks == whole.ticks[: len(run.ticks)]
        assert len(run.ticks) >= before
        before = len(run.ticks)
    assert before == len(whole.ticks)
    assert readable > len(lengths) // 2


@pytest.mark.parametrize("content", [b"", b"nonsense", b"\x89MCAP0\r\n", b"\x00" * 1000])
def test_what_is_no_recording_is_one_line(tmp_path, content):
    path = tmp_path / "x.mcap"
    path.write_bytes(content)
    with pytest.raises(RunFileError) as found:
        read_run(path)
    assert "\n" not in str(found.value)
    assert str(path) in str(found.value)


@pytest.mark.parametrize(("place", "bit"), [(0, 0), (3, 6), (9, 7), (20, 7), (25, 7), (37, 7)])
def test_one_flipped_bit_in_its_beginning_leaves_it_a_recording_of_farhand(recording, place, bit):
    data = bytearray(recording.read_bytes())
    data[place] ^= 1 << bit
    recording.write_bytes(data)
    with pytest.raises(RunFileError) as found:
        read_run(recording)
    beginning = "a recording of Farhand whose beginning, which says what run it is, is damaged or cut off"
    assert str(found.value) == f"run {recording}: {beginning}: it cannot be read"


def test_missing_files_and_foreign_formats(tmp_path):
    with pytest.raises(RunFileError, match="No such file"):
        read_run(tmp_path / "none.mcap")
    path = tmp_path / "old.mcap"
    RunRecorder(path, msgspec.structs.replace(INFO, format="farhand-run-0")).close()
    with pytest.raises(RunFileError, match=f"'farhand-run-0'; this program reads {FORMAT}"):
        read_run(path)


def test_a_recording_with_messages_of_the_schema_before_is_refused_as_what_it_is(tmp_path):
    path = tmp_path / "old.mcap"
    RunRecorder(path, msgspec.structs.replace(INFO, format="farhand-run-1")).close()
    with pytest.raises(RunFileError, match="it was recorded by another version"):
        read_run(path)


def test_a_recorded_task_holds_every_tick_and_all_that_arrived(tmp_path):
    from farhand.runs.scenario import load_scenario

    path = tmp_path / "run.mcap"
    scenario = load_scenario("point-obstacle")
    result = simulate(scenario, uplink="constant:20", downlink="constant:20", record_to=path, time_limit=2.0)
    run = read_run(path)
    assert run.complete
    assert len(run.ticks) == result.summary.ticks
    assert run.info.scenario["name"] == "point-obstacle"
    states = sum(key.endswith("/state") for tick in run.ticks for key, _, _ in tick.packets)
    assert 90 <= states <= 110
    assert all(arrived <= tick.now_ns for tick in run.ticks for _, arrived, _ in tick.packets)
