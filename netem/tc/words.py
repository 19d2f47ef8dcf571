"""A SPEC in the words of tc-netem: pure functions from words to the arguments of `tc qdisc`.

What tc-netem has not is refused, never left out. It differs from netem in this: it acts on packets, which
carry TCP, so that a lost one is sent again and comes late; its queue of LIMIT packets holds delayed packets
as well as waiting ones; and it takes no seed.

A correlation is refused, although `tc` takes it. The kernel blends uniform numbers, u = (1 - c) u' + c u, and
compares that with the probability, so that `loss 5% 25%` loses 0.2 %. Of a delay's u it takes the remainder of
a division, which is as good as independent: `delay 125ms 75ms 50%` has a correlation of 0.00.

Nor does a pfifo below netem keep packets in order, as tc-netem(8) says: since Linux 3.x netem always sorts by
time first. A rate does, since a packet then waits for the one before it; IN_ORDER is one that delays none.
"""

from typing import NamedTuple

from farhand.common.errors import SpecError
from farhand.netem.impairments.base import Word
from farhand.netem.impairments.constant import Constant
from farhand.netem.impairments.corrupt import Corrupt
from farhand.netem.impairments.delay import MeanSdWord
from farhand.netem.impairments.delay_by_trace import Empirical
from farhand.netem.impairments.duplicate import Duplicate
from farhand.netem.impairments.loss import FourState, Gilbert, Random
from farhand.netem.impairments.modelled import ModelWord, ProfileWord
from farhand.netem.impairments.rate import Rate
from farhand.netem.impairments.reorder import Reorder
from farhand.netem.impairments.slot import Slot
from farhand.netem.impairments.uniform import Uniform
from farhand.netem.spec import Spec
from farhand.netem.tc.tables import Table, empirical_table, mean_sd_table, model_of, model_table
from farhand.netem.words.reader import DEFAULT_QUEUE, milliseconds_text, percent_text

LIMIT = 10_000
"""Packets in the queue: 200 ms of 50,000 packets a second."""

LONGEST_NS = 274_000_000_000
"""Of a time: tc counts 64 ns in 32 bits."""


class KernelNetwork(NamedTuple):
    """One direction, for tc-netem.

    Attributes:
        arguments: what follows `netem`.
        table: the distribution whose file's name stands in `arguments` as TABLE.
    """

    arguments: tuple[str, ...] = ()
    table: Table | None = None


TABLE = "farhand"
IN_ORDER = ("rate", "100gbit")


def kernel_network(spec: Spec, direction: str) -> KernelNetwork:
    """The arguments that make tc-netem emulate `spec`; raises SpecError for what it cannot do."""
    if spec.classes:
        raise _refusal(f"{spec.classes[0][0]}[...]", "tells no kinds of messages apart")
    arguments: list[str] = []
    table: Table | None = None
    in_order = False
    for word in spec.words:
        if getattr(word, "correlation", 0.0):
            raise _refusal(word.text(), "correlates nothing, and changes rates where it is told to")
        if isinstance(word, Reorder) and word.mode != "gap":
            in_order = word.mode == "in-order"
        elif isinstance(word, ProfileWord | ModelWord):
            model = model_of(word)
            table = model_table(model)
            arguments += _table_arguments(table)
            loss = 1 - (1 - model.loss) ** 0.5 if model.path == "round-trip" else model.loss
            if loss and spec.word("loss") is not None:
                raise _refusal(word.text(), "has one loss model, and this one has losses of its own")
            if loss:
                leave = 1 - loss if model.loss_burst is None else 1 / model.loss_burst
                arguments += ["loss", "gemodel", *map(_percent, (leave * loss / (1 - loss), leave))]
        elif isinstance(word, MeanSdWord | Empirical):
            table = mean_sd_table(word) if isinstance(word, MeanSdWord) else empirical_table(word, direction)
            arguments += _table_arguments(table)
        else:
            arguments += _word_arguments(word)
    if spec.word("reorder") is not None and "reorder" in arguments and spec.word("delay") is None:
        raise _refusal("reorder:gap(...)", "sends some packets at once, which wants a delay for the others")
    if in_order and "delay" in arguments and "rate" not in arguments:
        arguments += IN_ORDER
    if not arguments:
        return KernelNetwork()
    return KernelNetwork(("limit", str(LIMIT), *arguments), table if table and table.entries else None)


def _word_arguments(word: Word) -> list[str]:
    if isinstance(word, Constant):
        return ["delay", _time(word.delay_ns)]
    if isinstance(word, Uniform):
        # Without a distribution the kernel draws evenly from mean - jitter to mean + jitter.
        middle, half = (word.low_ns + word.high_ns) // 2, (word.high_ns - word.low_ns) // 2
        return ["delay", _time(middle), *([_time(half)] if half else [])]
    if isinstance(word, Random):
        return ["loss", "random", _percent(word.probability)]
    if isinstance(word, Gilbert):
        return ["loss", "gemodel", *map(_percent, (word.p, word.r, word.bad, word.good))]
    if isinstance(word, FourState):
        return ["loss", "state", *map(_percent, (word.p13, word.p31, word.p32, word.p23, word.p14))]
    if isinstance(word, Duplicate | Corrupt):
        return [word.kind, _percent(word.probability)]
    if isinstance(word, Rate):
        if word.queue != DEFAULT_QUEUE:
            raise _refusal(word.text(), "counts its queue in packets, not in bytes")
        if word.bits_per_second < 8:
            raise _refusal(word.text(), "counts whole bytes a second")
        return ["rate", f"{word.bits_per_second}bit"]
    if isinstance(word, Reorder):
        return ["reorder", _percent(word.probability), "gap", str(word.gap)]
    if isinstance(word, Slot):
        count = ["packets", str(word.count)] if word.count else []
        return ["slot", _time(word.shortest_ns), _time(word.longest_ns), *count]
    raise _refusal(word.text(), "has nothing like it")


def _table_arguments(table: Table) -> list[str]:
    if not table.jitter_ns:
        return ["delay", _time(table.mean_ns)]
    return ["delay", _time(table.mean_ns), _time(table.jitter_ns), "distribution", TABLE]


def _refusal(word: str, why: str) -> SpecError:
    return SpecError(f"--backend tc: {word}: tc-netem {why}; use --backend message")


def _time(duration_ns: int) -> str:
    if duration_ns > LONGEST_NS:
        raise _refusal(f"{milliseconds_text(duration_ns)} ms", f"waits at most {LONGEST_NS // 10**9} s")
    return f"{milliseconds_text(duration_ns)}ms"


def _percent(probability: float) -> str:
    return percent_text(probability)
