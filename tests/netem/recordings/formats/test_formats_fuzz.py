"""Whatever the bytes, reading gives a Trace or a TraceError, and what is written is read back."""

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from farhand.common.errors import TraceError
from farhand.netem.models.profiles import load_model
from farhand.netem.recordings.formats.registry import FORMATS
from farhand.netem.recordings.rate import load_rate_trace
from farhand.netem.recordings.trace import Trace, load_trace
from farhand.netem.recordings.write import write_trace

QUIET = settings(max_examples=250, deadline=None, suppress_health_check=[HealthCheck.too_slow])

WORDS = [
    "# farhand trace",
    "# unit: ms",
    "# kind: round-trip",
    "# period: 10 ms",
    "time,delay",
    "rtt(ms)",
    "0,1",
    "1,lost",
    "PING a",
    "64 bytes from a: icmp_seq=1 ttl=1 time=3 ms",
    "no answer yet for icmp_seq=9",
    "Request timed out.",
    "[17.5] 64 bytes from a: icmp_seq=65535 time=3 ms",
    "64 bytes from a: icmp_seq=2 ttl=1 time=1.2.3 ms",
    "9 packets transmitted, 1 received, time 0ms",
    "pub_time(ms) sub_time(ms) delay(ms)",
    "1 2 3",
    "1 2 1e308",
    "5 6 -1",
    '{"round_trips": [',
    '{"lost": "true"},',
    '{"delay": {"rtt": 99999999999999999999999}}]}',
    "12",
    "-3",
    "nan",
    "1e400",
    '"',
    "'",
    ",,,",
    "\ufeff",
    "²",
    "٣",
    "1_000",
    "0x10",
    "inf",
]
texts = st.one_of(
    st.text(max_size=200),
    st.lists(st.sampled_from(WORDS), max_size=12).map("\n".join),
    st.lists(st.one_of(st.sampled_from(WORDS), st.text(max_size=20)), max_size=8).map("\n".join),
)
contents = st.one_of(st.binary(max_size=200), texts.map(lambda text: text.encode("utf-8", "surrogatepass")))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("traces")


def checked(read) -> None:
    message = ""
    try:
        found = read()
    except TraceError as error:
        message, found = str(error), None
    assert "\n" not in message
    if isinstance(found, Trace):
        arrived = found.recorded[~np.isnan(found.recorded)]
        assert len(arrived)
        assert (arrived >= 0).all()
        assert np.isfinite(arrived).all()
        if found.times is not None:
            assert len(found.times) == len(found.recorded)
            assert (np.diff(found.times) >= 0).all()
        found.summary()
        for direction in ("uplink", "downlink"):
            sampler = found.sampler(direction)
            for instant in (0, 1, 10**9, 10**12):
                delay = sampler.draw(instant)
                assert delay is None or 0 <= delay < math.inf


@QUIET
@given(
    contents,
    st.sampled_from([None, *FORMATS.names()]),
    st.sampled_from([None, "ms", "s"]),
    st.sampled_from([None, "delay", "1", "2", "rtt", "²"]),
    st.sampled_from([None, 0.01]),
    st.sampled_from(["loss", "delay", "ignore"]),
)
def test_any_bytes_give_a_trace_or_one_clear_line(folder, content, format, unit, column, period, gap):
    path = folder / "any_10ms.txt"
    path.write_bytes(content)
    checked(lambda: load_trace(path, format=format, unit=unit, column=column, period=period, gap=gap))


@QUIET
@given(contents)
def test_any_bytes_as_a_rate_trace_or_a_model(folder, content):
    path = folder / "rate"
    path.write_bytes(content)
    checked(lambda: load_rate_trace(path))
    checked(lambda: load_model(path))


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.one_of(st.floats(0, 3000), st.just(math.nan)), min_size=2, max_size=30),
    st.sampled_from(["times", "period", "neither"]),
    st.sampled_from(["one-way", "round-trip"]),
    st.sampled_from(["s", "ms", "us", "ns"]),
)
def test_what_is_written_is_read_back(folder, delays, timing, kind, unit):
    if all(math.isnan(delay) for delay in delays):
        delays = [*delays, 0.5]
    times = np.arange(len(delays)) * 0.02 if timing == "times" else None
    trace = Trace(np.array(delays), times, 0.02 if timing == "period" else None, kind, "somewhere, at night")
    path = folder / "written.csv"
    write_trace(trace, path, unit=unit)
    found = load_trace(path)
    np.testing.assert_allclose(found.recorded, trace.recorded, rtol=1e-8, atol=1e-18)
    assert (found.kind, found.period, found.provenance) == (trace.kind, trace.period, trace.provenance)
    assert (found.times is None) == (times is None)
    if timing != "neither":
        write_trace(trace, path, "slots", unit=unit, period=0.02)
        np.testing.assert_allclose(load_trace(path).recorded, trace.recorded, rtol=1e-8, atol=1e-18)
