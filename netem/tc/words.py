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

from collections.abc import Callable
from typing import Any, NamedTuple

from farhand.common.errors import SpecError
from farhand.netem.impairments.base import Word
from farhand.netem.impairments.constant import Constant
from farhand.netem.impairments.corrupt import Corrupt
from farhand.netem.impairments.delay import MeanSdWord
from farhand.netem.impairments.delay_by_trace import Empirical
from farhand.netem.impairments.duplicate import Duplicate
from farhand.netem.impairments.gaussian import Gaussian
from farhand.netem.impairments.limit import Limit
from farhand.netem.impairments.lognormal import LogNormal
from farhand.netem.impairments.loss import FourState, Gilbert, Random
from farhand.netem.impairments.modelled import ModelWord, ProfileWord
from farhand.netem.impairments.pareto import Pareto
from farhand.netem.impairments.paretonormal import ParetoNormal
from farhand.netem.impairments.rate import Rate
from farhand.netem.impairments.reorder import Reorder
from farhand.netem.impairments.slot import DrawnSlot, Slot
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
        table: the distribution whose file's name stands in `arguments` as TABLE, if it has entries.
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
    for word in spec.words:
        found = _ARGUMENTS.get(type(word), _refuse)(word, direction)
        arguments += found.arguments
        table = found.table or table
    _check_together(spec, arguments)
    if _is_in_order(spec) and "delay" in arguments and "rate" not in arguments:
        arguments += IN_ORDER
    if not arguments and spec.word("limit") is None:
        return KernelNetwork()
    bound = spec.word("limit")
    limit = bound.count if isinstance(bound, Limit) else LIMIT
    return KernelNetwork(("limit", str(limit), *arguments), table if table and table.entries else None)


def _check_together(spec: Spec, arguments: list[str]) -> None:
    """Raise SpecError for words that tc-netem can make each, but not together."""
    if arguments.count("loss") > 1:
        delay = spec.word("delay")
        assert delay is not None
        raise _refusal(delay.text(), "has one loss model, and this one has losses of its own")
    if "reorder" in arguments and spec.word("delay") is None:
        raise _refusal("reorder:gap(...)", "sends some packets at once, which wants a delay for the others")


def _is_in_order(spec: Spec) -> bool:
    word = spec.word("reorder")
    return isinstance(word, Reorder) and word.mode == "in-order"


def _refuse(word: Word, direction: str) -> KernelNetwork:
    raise _refusal(word.text(), "has nothing like it")


def _constant(word: Constant, direction: str) -> KernelNetwork:
    return KernelNetwork(("delay", _time(word.delay_ns)))


def _uniform(word: Uniform, direction: str) -> KernelNetwork:
    """Without a distribution the kernel draws evenly from mean - jitter to mean + jitter."""
    _refuse_correlation(word, word.correlation)
    middle, half = (word.low_ns + word.high_ns) // 2, (word.high_ns - word.low_ns) // 2
    return KernelNetwork(("delay", _time(middle), *([_time(half)] if half else [])))


def _mean_sd(word: MeanSdWord, direction: str) -> KernelNetwork:
    _refuse_correlation(word, word.correlation)
    return _distribution(mean_sd_table(word))


def _empirical(word: Empirical, direction: str) -> KernelNetwork:
    return _distribution(empirical_table(word, direction))


def _model(word: ProfileWord | ModelWord, direction: str) -> KernelNetwork:
    model = model_of(word)
    delays = _distribution(model_table(model))
    loss = 1 - (1 - model.loss) ** 0.5 if model.path == "round-trip" else model.loss
    if not loss:
        return delays
    leave = 1 - loss if model.loss_burst is None else 1 / model.loss_burst
    losses = ("loss", "gemodel", percent_text(leave * loss / (1 - loss)), percent_text(leave))
    return KernelNetwork((*delays.arguments, *losses), delays.table)


def _random(word: Random, direction: str) -> KernelNetwork:
    _refuse_correlation(word, word.correlation)
    return KernelNetwork(("loss", "random", percent_text(word.probability)))


def _gilbert(word: Gilbert, direction: str) -> KernelNetwork:
    return KernelNetwork(("loss", "gemodel", *map(percent_text, (word.p, word.r, word.bad, word.good))))


def _four_state(word: FourState, direction: str) -> KernelNetwork:
    values = (word.p13, word.p31, word.p32, word.p23, word.p14)
    return KernelNetwork(("loss", "state", *map(percent_text, values)))


def _event(word: Duplicate | Corrupt, direction: str) -> KernelNetwork:
    _refuse_correlation(word, word.correlation)
    return KernelNetwork((word.kind, percent_text(word.probability)))


def _rate(word: Rate, direction: str) -> KernelNetwork:
    if word.queue != DEFAULT_QUEUE:
        raise _refusal(word.text(), "counts its queue in packets, not in bytes")
    if word.overhead:
        raise _refusal(word.text(), "adds its overhead to packets, which have their headers already")
    if word.bits_per_second < 8:
        raise _refusal(word.text(), "counts whole bytes a second")
    return KernelNetwork(("rate", f"{word.bits_per_second}bit"))


def _reorder(word: Reorder, direction: str) -> KernelNetwork:
    """What is as drawn needs no words, and what is in order a rate (see `kernel_network`)."""
    if word.mode != "gap":
        return KernelNetwork()
    _refuse_correlation(word, word.correlation)
    return KernelNetwork(("reorder", percent_text(word.probability), "gap", str(word.gap)))


def _slot(word: Slot, direction: str) -> KernelNetwork:
    count = ("packets", str(word.count)) if word.count else ()
    size = ("bytes", str(word.size)) if word.size else ()
    return KernelNetwork(("slot", _time(word.shortest_ns), _time(word.longest_ns), *count, *size))


def _drawn_slot(word: DrawnSlot, direction: str) -> KernelNetwork:
    raise _refusal(
        word.text(), "takes a distribution of slots from files of its own, which are not written here"
    )


def _limit(word: Limit, direction: str) -> KernelNetwork:
    """Stands at the head of the arguments (see `kernel_network`)."""
    return KernelNetwork()


_ARGUMENTS: dict[type[Word], Callable[[Any, str], KernelNetwork]] = {
    Constant: _constant,
    Uniform: _uniform,
    Gaussian: _mean_sd,
    Pareto: _mean_sd,
    ParetoNormal: _mean_sd,
    LogNormal: _mean_sd,
    Empirical: _empirical,
    ProfileWord: _model,
    ModelWord: _model,
    Random: _random,
    Gilbert: _gilbert,
    FourState: _four_state,
    Duplicate: _event,
    Corrupt: _event,
    Rate: _rate,
    Reorder: _reorder,
    Slot: _slot,
    DrawnSlot: _drawn_slot,
    Limit: _limit,
}
"""By the very type: a word that somebody derived from one of these may do something else, and is refused."""


def _refuse_correlation(word: Word, correlation: float) -> None:
    if correlation:
        raise _refusal(word.text(), "correlates nothing, and changes rates where it is told to")


def _distribution(table: Table) -> KernelNetwork:
    if not table.jitter_ns:
        return KernelNetwork(("delay", _time(table.mean_ns)), table)
    return KernelNetwork(
        ("delay", _time(table.mean_ns), _time(table.jitter_ns), "distribution", TABLE), table
    )


def _refusal(word: str, why: str) -> SpecError:
    return SpecError(f"--backend tc: {word}: tc-netem {why}; use --backend message")


def _time(duration_ns: int) -> str:
    if duration_ns > LONGEST_NS:
        raise _refusal(f"{milliseconds_text(duration_ns)} ms", f"waits at most {LONGEST_NS // 10**9} s")
    return f"{milliseconds_text(duration_ns)}ms"
