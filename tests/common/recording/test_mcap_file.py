"""The container: what others' readers see of it, whole or cut, whatever the disk does."""

import io
import zlib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader

from farhand.common.recording.mcap_file import ChannelSpec, McapFile
from farhand.testing.disk import ScriptedFile
from tests.examples import THOROUGH

CHANNELS = (ChannelSpec("/a", "json", "A", "jsonschema", b"{}"), ChannelSpec("/b", "msgpack", "B"))


def written(chunks, fails=lambda number: False):
    """The file and the payloads that are in it, from chunks of (channel, time, data)."""
    disk = ScriptedFile()
    file = McapFile(disk, "x", "y", CHANNELS)
    kept = []
    for number, chunk in enumerate(chunks):
        disk.fails = lambda _, number=number: fails(number)
        for channel, at, data in chunk:
            file.add(channel, at, data, number)
        try:
            file.flush()
        except OSError:
            continue
        kept += [(CHANNELS[channel - 1].topic, at, data) for channel, at, data in chunk]
    disk.fails = lambda _: False
    file.metadata("m", {"k": "v"})
    file.close()
    return disk.read_bytes(), kept


MESSAGES = st.lists(
    st.lists(st.tuples(st.sampled_from([1, 2]), st.integers(0, 2**62), st.binary(max_size=30)), max_size=5),
    max_size=6,
)


@settings(max_examples=60, deadline=None)
@given(MESSAGES, st.sets(st.integers(0, 5)))
def test_another_reader_finds_all_that_was_written_by_index_and_in_order(chunks, failing):
    data, kept = written(chunks, lambda number: number in failing)
    reader = make_reader(io.BytesIO(data), validate_crcs=True)
    found = [(channel.topic, m.log_time, m.data) for _, channel, m in reader.iter_messages()]
    assert sorted(found) == sorted(kept)
    assert [each.log_time for _, _, each in reader.iter_messages()] == sorted(at for _, at, _ in kept)
    summary = reader.get_summary()
    assert {c.topic for c in summary.channels.values()} == {"/a", "/b"}
    assert summary.statistics.message_count == len(kept)
    if kept:
        times = [at for _, at, _ in kept]
        assert (summary.statistics.message_start_time, summary.statistics.message_end_time) == (
            min(times),
            max(times),
        )
    assert [m.metadata for m in reader.iter_metadata()] == [{"k": "v"}]


def test_the_summary_s_checksum_is_that_of_its_bytes():
    data, _ = written([[(1, 5, b"{}")]])
    footer = data[-8 - 29 : -8]
    start = int.from_bytes(footer[9:17], "little")
    assert zlib.crc32(data[start : len(data) - 8 - 4]) == int.from_bytes(footer[-4:], "little")


@pytest.mark.thorough
def test_a_stream_reader_gets_every_whole_chunk_of_a_file_that_is_cut_off():
    data, kept = written([[(1, n, b"%d" % n)] for n in range(20)])
    seen = set()
    for length in range(0, len(data), 1 if THOROUGH else 7):
        found = []
        try:
            for record in StreamReader(io.BytesIO(data[:length])).records:
                if type(record).__name__ == "Message":
                    found.append(record.data)
        except Exception:  # the cut
            pass
        assert found == [each for _, _, each in kept[: len(found)]]
        seen.add(len(found))
    assert seen == set(range(21))
