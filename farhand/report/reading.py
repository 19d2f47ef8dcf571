"""A recording's ticks and gaps in order, and whatever else is wanted of it, one after another."""

from collections.abc import Iterator

import msgspec

from farhand.common.recording.reader import DAMAGED, Entry, RunReader
from farhand.common.recording.records import TICK, Gap, TickRecord


def recorded(reader: RunReader, others: set[str]) -> Iterator[TickRecord | Gap | Entry]:
    """Ticks, gaps between and after them as noted or as the numbers tell, and messages of `others`."""
    decode = msgspec.msgpack.Decoder(TickRecord).decode
    expected = reader.info.first_tick
    count = left_out = last_ns = 0
    for item in reader.items(lambda topic: topic == TICK or topic in others):
        if isinstance(item, Gap):
            expected += item.ticks
            yield item
            continue
        if item.topic != TICK:
            yield item
            continue
        try:
            tick = decode(item.data)
        except msgspec.MsgspecError:
            continue  # its number is missing, which is told of
        if tick.number > expected:
            left_out += tick.number - expected
            yield Gap(
                ticks=tick.number - expected,
                first_ns=last_ns or tick.now_ns,
                last_ns=tick.now_ns,
                why=DAMAGED,
                before=count,
            )
        expected, last_ns = tick.number + 1, tick.now_ns
        count += 1
        yield tick
    lost = reader.promised.get(TICK, 0) - count - left_out
    if lost > 0:  # the last ones: no number after them tells
        yield Gap(ticks=lost, first_ns=last_ns, last_ns=last_ns, why=DAMAGED, before=count)
