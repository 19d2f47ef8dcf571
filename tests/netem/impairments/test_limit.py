"""`limit:N` bounds the messages under way, and a rate's overhead counts with every message."""

import pytest

from farhand.common.link.link import Packet
from farhand.netem.chain import Chain
from farhand.netem.spec import parse_spec

MS = 1_000_000


def fates(spec, instants_ms, size=0):
    chain = Chain(parse_spec(spec), 1, "uplink")
    return [chain.offer(Packet("a", bytes(size), at * MS), at * MS)[0] for at in instants_ms]


def test_one_more_than_the_limit_is_dropped_until_one_has_left():
    found = fates("constant:10 limit:2", [0, 1, 2, 3, 10, 11, 12])
    assert [transit.cause for transit in found] == ["", "", "limit", "limit", "", "", "limit"]


def test_overhead_takes_time_of_the_rate():
    plain, more = (fates(spec, [0], size=100)[0].release_ns for spec in ("rate:1mbit", "rate:1mbit,64kB,25B"))
    assert (plain, more) == (800_000, 1_000_000)


@pytest.mark.parametrize("text", ["limit:7", "rate:2mbit,256000B,40B"])
def test_they_are_written_as_they_are_read(text):
    assert str(parse_spec(text)) == text
