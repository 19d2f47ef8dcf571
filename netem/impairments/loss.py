"""The word `loss:` in its forms: a probability, `gilbert(...)`, `state(...)` and `trace(FILE)`."""

import math
from typing import ClassVar

from farhand.netem.impairments.base import Impairment, ImpairmentContext, LossModel, Stage, Transit, Word
from farhand.netem.impairments.loss_markov import MarkovLoss
from farhand.netem.impairments.loss_random import RandomEvents, RandomLoss
from farhand.netem.impairments.trace_file import (
    Options,
    open_trace,
    options_text,
    parse_options,
    prepare_trace,
)
from farhand.netem.recordings.playback import DelaySampler
from farhand.netem.words.reader import SpecReader, path_text, percent_text


class LossWord(Word, frozen=True):
    """Any of the loss models."""

    name: ClassVar[str] = "loss"
    example: ClassVar[str] = "loss:1% or loss:gilbert(1%,10%)"
    description: ClassVar[str] = "messages are lost at random, or in bursts"
    kind: ClassVar[str] = "loss"
    stage: ClassVar[Stage] = Stage.LOSS

    @classmethod
    def parse(cls, reader: SpecReader) -> "LossWord":
        """`:P[,CORRELATION%]`, `:gilbert(...)`, `:state(...)` or `:trace(FILE...)`."""
        reader.expect(":", "the loss")
        for name, form in FORMS.items():
            if reader.take(f"{name}("):
                found = form.arguments(reader)
                reader.expect(")", "")
                return found
        return Random.arguments(reader)

    @classmethod
    def arguments(cls, reader: SpecReader) -> "LossWord":
        """Read the parameters of one form."""
        raise NotImplementedError


class Random(LossWord, frozen=True):
    """Random loss.

    Attributes:
        probability: of loss.
        correlation: of neighbouring messages of one key.
    """

    probability: float
    correlation: float = 0.0

    @classmethod
    def arguments(cls, reader: SpecReader) -> "Random":
        """`P[,CORRELATION%]`."""
        return cls(reader.probability("the probability of loss"), reader.optional_correlation())

    def text(self) -> str:
        """Canonical word."""
        tail = f",{percent_text(self.correlation)}" if self.correlation else ""
        return f"loss:{percent_text(self.probability)}{tail}"

    def build(self, context: ImpairmentContext) -> Impairment:
        """Random losses."""
        return RandomLoss(RandomEvents(context, "loss", self.probability, self.correlation))


class Gilbert(LossWord, frozen=True):
    """Gilbert-Elliott: a good and a bad state (tc: `loss gemodel p r 1-h 1-k`).

    Loss rate (p (1-h) + r (1-k)) / (p + r); mean burst 1 / r where the bad state loses all, the good none.

    Attributes:
        p: good to bad.
        r: bad to good.
        bad: probability of loss in the bad state, tc's 1-h.
        good: probability of loss in the good state, tc's 1-k.
    """

    p: float
    r: float
    bad: float = 1.0
    good: float = 0.0

    @classmethod
    def arguments(cls, reader: SpecReader) -> "Gilbert":
        """`P,R[,1-H[,1-K]]`."""
        reader.example = "loss:gilbert(1%,10%)"
        p = reader.probability("p, from good to bad")
        reader.expect(",", "r, from bad to good")
        r = reader.probability("r, from bad to good")
        bad = reader.probability("1-h, the loss in the bad state") if reader.take(",") else 1.0
        good = reader.probability("1-k, the loss in the good state") if reader.take(",") else 0.0
        return cls(p, r, bad, good)

    def text(self) -> str:
        """Canonical word."""
        values = [self.p, self.r, self.bad, self.good]
        kept = 4 if self.good != 0.0 else 3 if self.bad != 1.0 else 2
        return f"loss:gilbert({','.join(map(percent_text, values[:kept]))})"

    def build(self, context: ImpairmentContext) -> Impairment:
        """The two-state chain."""
        return MarkovLoss(context, [[1 - self.p, self.p], [self.r, 1 - self.r]], [self.good, self.bad])


class FourState(LossWord, frozen=True):
    """Four-state Markov chain (tc: `loss state p13 p31 p32 p23 p14`).

    States: 1 gap, received; 2 burst, received; 3 burst, lost; 4 gap, lost alone.

    Attributes:
        p13, p31, p32, p23, p14: transition probabilities.
    """

    p13: float
    p31: float
    p32: float = 0.0
    p23: float = 1.0
    p14: float = 0.0

    @classmethod
    def arguments(cls, reader: SpecReader) -> "FourState":
        """`P13[,P31[,P32[,P23[,P14]]]]`."""
        reader.example = "loss:state(1%,20%,10%,30%,0.5%)"
        p13 = reader.probability("p13, from received to a burst of losses")
        rest = {"p31": round(1 - p13, 12), "p32": 0.0, "p23": 1.0, "p14": 0.0}
        start = reader.position
        for name in rest:
            if not reader.take(","):
                break
            rest[name] = reader.probability(name)
        if rest["p31"] + rest["p32"] > 1 + 1e-12 or p13 + rest["p14"] > 1 + 1e-12:
            reader.fail("p31 + p32 and p13 + p14 must not be above 100%", start)
        return cls(p13, **rest)

    def text(self) -> str:
        """Canonical word."""
        values = [self.p13, self.p31, self.p32, self.p23, self.p14]
        return f"loss:state({','.join(map(percent_text, values))})"

    def build(self, context: ImpairmentContext) -> Impairment:
        """The four-state chain."""
        p13, p31, p32, p23, p14 = self.p13, self.p31, self.p32, self.p23, self.p14
        transitions = [
            [max(0.0, 1 - p13 - p14), 0.0, p13, p14],
            [0.0, 1 - p23, p23, 0.0],
            [p31, p32, max(0.0, 1 - p31 - p32), 0.0],
            [1.0, 0.0, 0.0, 0.0],
        ]
        return MarkovLoss(context, transitions, [0.0, 0.0, 1.0, 1.0])


class LossTrace(LossWord, frozen=True):
    """Losses of a recording: a message is lost where the recording lost one.

    Attributes:
        path: the file.
        options: for `load_trace`.
    """

    path: str
    options: Options = ()

    @classmethod
    def arguments(cls, reader: SpecReader) -> "LossTrace":
        """`FILE[,OPTION=VALUE...]`."""
        reader.example = "loss:trace(delays.csv)"
        return cls(reader.path("the trace's file"), parse_options(reader))

    def text(self) -> str:
        """Canonical word."""
        return f"loss:trace({path_text(self.path)}{options_text(self.options)})"

    def prepare(self) -> None:
        """Read the file; raises TraceError."""
        prepare_trace(self.path, self.options)

    def build(self, context: ImpairmentContext) -> Impairment:
        """The losses of the trace."""
        trace = open_trace(self.path, self.options)
        sampler = trace.sampler(context.direction)
        if trace.duration is not None:
            sampler.draw(context.origin_ns)
        return _TraceLoss(sampler)


class _TraceLoss(LossModel):
    def __init__(self, sampler: DelaySampler) -> None:
        self._sampler = sampler

    def loses(self, transit: Transit, instant_ns: int) -> bool:
        delay = self._sampler.draw(instant_ns)
        return delay is None or math.isnan(delay)


FORMS: dict[str, type[LossWord]] = {
    "gilbert": Gilbert,
    "state": FourState,
    "trace": LossTrace,
    "random": Random,
}
