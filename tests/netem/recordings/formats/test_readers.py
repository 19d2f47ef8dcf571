"""Each format of delay traces: what it says, and the one line for what is wrong with it."""

import json
import math

import numpy as np
import pytest

from farhand.common.errors import TraceError
from farhand.netem.recordings.trace import load_trace


def write(tmp_path, content, name="trace.txt"):
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def test_own_csv_has_unit_kind_times_and_losses(tmp_path):
    path = write(
        tmp_path,
        "# farhand trace\n# unit: ms\n# kind: round-trip\n# provenance: lab\ntime,delay\n"
        "0.0,15.5\n0.1,lost\n0.2,\n0.3,20\n",
    )
    trace = load_trace(path)
    assert (trace.kind, trace.provenance) == ("round-trip", "lab")
    np.testing.assert_allclose(trace.recorded, [0.0155, math.nan, math.nan, 0.02])
    np.testing.assert_allclose(trace.delays, trace.recorded / 2)
    np.testing.assert_allclose(trace.times, [0, 0.1, 0.2, 0.3])
    assert trace.summary()["loss"] == 0.5


@pytest.mark.parametrize(
    ("content", "options", "expected"),
    [
        ("rtt(ms)\n12\n13\n", {}, [0.012, 0.013]),
        ("delay_us\n12\n", {}, [12e-6]),
        ("a,b\n1,2\n3,4\n", {"column": "b", "unit": "s"}, [2, 4]),
        ("1,2\n3,4\n", {"column": "2", "unit": "ms"}, [0.002, 0.004]),
        ("time(ms),latency\n0,1\n500,2\n", {"unit": "ms"}, [0.001, 0.002]),
    ],
)
def test_other_csv(tmp_path, content, options, expected):
    trace = load_trace(write(tmp_path, content), format="csv", **options)
    np.testing.assert_allclose(trace.recorded, expected)
    assert trace.kind == ("round-trip" if content.startswith("rtt") else "one-way")


def test_linux_ping_with_a_hole_a_duplicate_and_a_late_answer(tmp_path):
    path = write(
        tmp_path,
        "PING host (192.0.2.1) 56(84) bytes of data.\n"
        "64 bytes from 192.0.2.1: icmp_seq=1 ttl=57 time=11.6 ms\n"
        "no answer yet for icmp_seq=2\n"
        "64 bytes from 192.0.2.1: icmp_seq=4 ttl=57 time=12.0 ms\n"
        "64 bytes from 192.0.2.1: icmp_seq=2 ttl=57 time=1200 ms\n"
        "64 bytes from 192.0.2.1: icmp_seq=4 ttl=57 time=13.0 ms (DUP!)\n"
        "From 192.0.2.9 icmp_seq=5 Destination Host Unreachable\n"
        "\n--- host ping statistics ---\n"
        "5 packets transmitted, 3 received, +1 duplicates, 40% packet loss, time 800ms\n"
        "rtt min/avg/max/mdev = 11.6/12.2/13.0/0.5 ms\n",
    )
    trace = load_trace(path)
    np.testing.assert_allclose(trace.recorded, [0.0116, 1.2, math.nan, 0.012, math.nan])
    assert trace.kind == "round-trip"
    assert trace.period == pytest.approx(0.2)


def test_ping_with_time_stamps_gives_sending_times(tmp_path):
    lines = [
        f"[{1700000000 + 0.5 * k + 0.01:.6f}] 64 bytes from ::1: icmp_seq={k} ttl=1 time=10.0 ms"
        for k in (1, 2, 4)
    ]
    trace = load_trace(write(tmp_path, "\n".join(lines)))
    np.testing.assert_allclose(trace.times, [0, 0.5, 1.0, 1.5], atol=1e-5)
    assert np.isnan(trace.recorded).tolist() == [False, False, True, False]


def test_ping_counts_on_beyond_its_16_bits(tmp_path):
    lines = [f"64 bytes from 1: icmp_seq={n % 65536} ttl=1 time={n % 7 + 1} ms" for n in range(65530, 65545)]
    trace = load_trace(write(tmp_path, "\n".join(lines)))
    np.testing.assert_allclose(trace.recorded, [(n % 7 + 1) / 1e3 for n in range(65530, 65545)])


def test_windows_and_mac_ping(tmp_path):
    windows = "Pinging a with 32 bytes of data:\nReply from 1: bytes=32 time=11ms TTL=5\nRequest timed out.\n"
    np.testing.assert_allclose(load_trace(write(tmp_path, windows)).recorded, [0.011, math.nan])
    mac = (
        "PING a (1): 56 data bytes\n64 bytes from 1: icmp_seq=0 ttl=5 time=2.5 ms\n"
        "Request timeout for icmp_seq 1\n64 bytes from 1: icmp_seq=2 ttl=5 time=3.5 ms\n"
    )
    np.testing.assert_allclose(load_trace(write(tmp_path, mac)).recorded, [0.0025, math.nan, 0.0035])


def irtt(**changes):
    def trip(n):
        stamps = {"client": {"send": {"monotonic": 20_000_000 * n, "wall": 5}}}
        delay = {"rtt": 15_000_000 + n, "send": 7_000_000, "receive": 8_000_000}
        return {"seqno": n, "lost": "false", "timestamps": stamps, "delay": delay}

    trips = [trip(n) for n in range(4)]
    trips[2] = {"seqno": 2, "lost": "true_up", "timestamps": trips[2]["timestamps"], "delay": {}}
    return json.dumps({"version": {}, "round_trips": trips} | changes, indent=1)


def test_irtt(tmp_path):
    path = write(tmp_path, irtt(), "irtt.json")
    trace = load_trace(path)
    np.testing.assert_allclose(trace.recorded, [0.015, 0.015, math.nan, 0.015], atol=1e-7)
    np.testing.assert_allclose(trace.times, [0, 0.02, 0.04, 0.06])
    assert trace.kind == "round-trip"
    with pytest.raises(TraceError, match="does not know whether its two clocks agree"):
        load_trace(path, column="send")
    one_way = load_trace(path, column="send", kind="one-way")
    assert one_way.kind == "one-way"
    np.testing.assert_allclose(one_way.delays[:2], 0.007)


CICV5G = "pub_time(ms) sub_time(ms) delay(ms) utmX(m)\n"


def test_cicv5g_missing_rows_are_lost_echoes_unless_ignored(tmp_path):
    rows = "".join(f"{1000 + 50 * n} {1015 + 50 * n} 15 1.0 \n" for n in (0, 1, 2, 3, 6, 7))
    path = write(tmp_path, CICV5G + rows)
    trace = load_trace(path)
    assert np.isnan(trace.recorded).tolist() == [False] * 4 + [True] * 2 + [False] * 2
    np.testing.assert_allclose(trace.times, np.arange(8) * 0.05)
    ignored = load_trace(path, gap="ignore")
    assert not np.isnan(ignored.recorded).any()
    assert len(ignored.recorded) == 6


def test_a_pause_of_the_recording_is_cut_out(tmp_path):
    times = [0, 50, 100, 150, 200, 90_000, 90_050]
    trace = load_trace(write(tmp_path, CICV5G + "".join(f"{t} {t + 9} 9 0\n" for t in times)))
    assert not np.isnan(trace.recorded).any()
    assert trace.duration == pytest.approx(0.35)


def test_slots_take_their_length_from_name_header_or_caller(tmp_path):
    for path, options in (
        (write(tmp_path, "12\n13\n", "oneway_10ms_slots.txt"), {}),
        (write(tmp_path, "# period: 10 ms\n12\n13\n", "a.txt"), {}),
        (write(tmp_path, "12\n13\n", "b.txt"), {"period": 0.01}),
    ):
        trace = load_trace(path, **options)
        assert trace.period == pytest.approx(0.01)
        np.testing.assert_allclose(trace.delays, [0.012, 0.013])


@pytest.mark.parametrize(
    ("content", "options", "words"),
    [
        ("", {}, "is empty"),
        ("\n \n", {}, "is empty"),
        (b"\xff\xfe1", {}, "line 1: not text"),
        (b"1\n2\n\xff\n", {}, "line 3: not text"),
        ("1\n\0\n", {}, "line 2: not text"),
        ("hello\n", {}, "unknown format"),
        ("1\n2\n", {}, "how long is a slot"),
        ("1\n-2\n", {"period": 0.01}, "line 2: the delay is negative"),
        ("1\nx\n", {"period": 0.01}, "line 2: expected one delay"),
        ("1\ninf\n", {"period": 0.01}, "line 2: expected one delay"),
        ("lost\nlost\n", {"period": 0.01}, "every message is lost"),
        ("a,b\n1,2\n", {"unit": "ms"}, "which column is the delay"),
        ("Prose, with a comma.\n\nIn 5 lines, some,\n", {}, "no recording of delays: no row"),
        ("a,b\n1,2\n", {"unit": "ms", "column": "c"}, "no column 'c'"),
        ("time,delay\n0,2\n", {}, "no unit"),
        ("time,delay\n0,2\n", {"unit": "min"}, "unit 'min' is unknown"),
        ("time,delay\n1,2\n0,2\n", {"unit": "ms"}, "line 3: the time goes backwards"),
        ("time,delay\n1,2\n2\n", {"unit": "ms"}, "line 3: 1 columns where 2"),
        ("time,delay\n1,1e9\n", {"unit": "s"}, "more than an hour"),
        ("# farhand trace\n# unit: ms\n# kind: both\ndelay\n1\n", {}, "kind 'both'"),
        ("# farhand trace\n# unit: ms\n", {}, "no samples"),
        ("PING a\n64 bytes from a: icmp_seq=1 ttl=5 time=-3 ms\n", {}, "line 2"),
        ("PING a\n64 bytes from a: icmp_seq=70000 ttl=5 time=3 ms\n", {}, "line 2: icmp_seq 70000"),
        ("PING a\n", {}, "no samples"),
        (CICV5G + "1 2\n", {}, "line 2: 2 columns where 4"),
        (CICV5G + "1 2 -3 4\n", {}, "line 2: the delay is negative"),
        ('{"round_trips": [{"delay": {"rtt": "x"}}]}', {}, "round_trips[0].delay.rtt"),
        ('{"round_trips": 3}', {}, "not the JSON of irtt"),
        ("1\n", {"format": "pcap"}, "format 'pcap': no such trace format; there are cicv5g"),
        ("1\n", {"period": -1}, "the period is -1"),
        ("1\n", {"gap": "maybe"}, "gap 'maybe'"),
        ("delay\n1\nlost\n", {"unit": "ms", "gap": "delay"}, "needs the times"),
    ],
)
def test_what_is_wrong_is_one_line(tmp_path, content, options, words):
    path = write(tmp_path, content)
    with pytest.raises(TraceError) as caught:
        load_trace(path, **options)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value)


def test_a_missing_file(tmp_path):
    with pytest.raises(TraceError, match="cannot be read"):
        load_trace(tmp_path / "none")
    with pytest.raises(TraceError, match="cannot be read"):
        load_trace(tmp_path)
