"""What a file is packed and encoded in makes no difference, nor its size; what is missing of it is said."""

import gzip

import numpy as np
import pytest

from farhand.common.errors import TraceError
from farhand.netem.recordings import text_file
from farhand.netem.recordings.text_file import read_text
from farhand.netem.recordings.trace import load_trace

TEXT = "time_s,rtt_ms\r\n" + "".join(f"{k / 50:.2f},{10 + k % 5}\r\n" for k in range(3000))


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("most", [1000, 10**8])
def test_all_give_the_same_lines(tmp_path, monkeypatch, encoding, packed, most):
    monkeypatch.setattr(text_file, "MAX_BYTES", most)
    monkeypatch.setattr(text_file, "_CHUNK", 777)
    path = tmp_path / "any"
    content = TEXT.encode(encoding)
    path.write_bytes(gzip.compress(content) if packed else content)
    text = read_text(path)
    assert list(text.lines) == TEXT.replace("\r\n", "\n").split("\n")
    assert (text.lines[-1], text.lines[-2], text.lines[1:3]) == ("", "59.98,14", ["0.00,10", "0.02,11"])
    trace = load_trace(path)
    np.testing.assert_allclose(trace.recorded * 1e3, 10 + np.arange(3000) % 5)
    assert ("packed" in trace.reading.how, "size" in trace.reading.how) == (packed, most == 1000)


def test_a_packed_file_that_was_cut_off_is_read_up_to_there(tmp_path):
    path = tmp_path / "cut.gz"
    packed = gzip.compress(TEXT.encode())
    path.write_bytes(packed[: len(packed) // 2])
    trace = load_trace(path)
    assert 100 < len(trace.recorded) < 3000
    assert any("cut off or damaged" in note for note in trace.reading.notes)


def test_there_is_a_largest_size(tmp_path, monkeypatch):
    monkeypatch.setattr(text_file, "MAX_BYTES", 1000)
    monkeypatch.setattr(text_file, "MAX_STREAMED", 5000)
    (tmp_path / "large").write_text(TEXT)
    with pytest.raises(TraceError, match="larger than"):
        load_trace(tmp_path / "large")
