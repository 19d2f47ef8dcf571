"""Recorded delays, in whatever format a file seems to have or is said to have."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from farhand.common.errors import TraceError
from farhand.netem.recordings.formats.registry import FORMATS
from farhand.netem.recordings.trace import Trace, load_trace
from farhand.trials.fuzz.files import scratch
from farhand.trials.fuzz.target import Target, check, one_line

TEXTS = (
    "# farhand trace\n# unit: ms\n# kind: round-trip\ntime,delay\n0,20\n0.1,22\n0.2,lost\n",
    "PING 10.0.0.1 (10.0.0.1) 56(84) bytes of data.\n64 bytes from 10.0.0.1: icmp_seq=1 ttl=64 time=3.1 ms\n"
    "no answer yet for icmp_seq=2\n[17.5] 64 bytes from 10.0.0.1: icmp_seq=3 ttl=64 time=2 ms\n"
    "3 packets transmitted, 2 received, 33% packet loss, time 2003ms\n",
    "Reply from 10.0.0.1: bytes=32 time=3ms TTL=64\nRequest timed out.\n"
    "Reply from 10.0.0.1: bytes=32 time<1ms TTL=64\n",
    "10.0.0.1 : [0], 64 bytes, 3.10 ms (3.10 avg, 0% loss)\n10.0.0.1 : [1], timed out (NaN avg, 50% loss)\n",
    "len=46 ip=10.0.0.1 ttl=64 DF id=0 sport=80 flags=SA seq=0 win=64240 rtt=3.1 ms\n",
    "pub_time(ms) sub_time(ms) delay(ms)\n1000 1020 20\n1100 1125 25\n",
    '{"round_trips": [{"seqno": 0, "lost": "false", "delay": {"rtt": 3000000}, '
    '"timestamps": {"client": {"send": {"wall": 1000}}}}, {"seqno": 1, "lost": "true"}]}',
    "12\n14\nnan\n13\n",
    "t;rtt\n0,0;1,5\n0,1;1,6\n",
)
OPTIONS: tuple[dict[str, Any], ...] = (
    {},
    {"unit": "ms"},
    {"period": 0.01, "gap": "delay"},
    {"column": "2", "sort": True, "lost": "-1"},
)


def seeds() -> list[bytes]:
    """A file of each format behind two bytes: as which format, with which options."""
    return [bytes([0, number % 2]) + text.encode() for number, text in enumerate(TEXTS)]


def start() -> Callable[[bytes], None]:
    """See Target."""
    path, formats = scratch("any_10ms.txt"), (None, *FORMATS.names())

    def take(data: bytes) -> None:
        name = formats[data[0] % len(formats)] if data else None
        options = OPTIONS[data[1] % len(OPTIONS)] if len(data) > 1 else {}
        path.write_bytes(data[2:])
        try:
            found = load_trace(path, format=name, **options)
        except TraceError as error:
            one_line(error)
            return
        _judge(found)

    return take


def _judge(found: Trace) -> None:
    arrived = found.recorded[~np.isnan(found.recorded)]
    check(len(arrived) > 0 and bool((arrived >= 0.0).all()), "a delay is negative, or there is none")
    check(bool(np.isfinite(arrived).all()), "a delay is not finite")
    found.summary()
    for direction in ("uplink", "downlink"):
        sampler = found.sampler(direction)
        for instant in (0, 1, 10**9, 10**12):
            delay = sampler.draw(instant)
            check(delay is None or 0 <= delay < math.inf, "a delay that is drawn is none")


TARGET = Target(
    edge="delay traces: all formats, by content and as said",
    promise="a refusal is one line; delays are finite and not negative",
    seeds=seeds,
    start=start,
    shape="text",
    head=2,
)
