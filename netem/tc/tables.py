"""Distributions for tc-netem: tables of quantiles, in the form that `tc` reads.

tc-netem draws one entry t of the table for each packet, evenly, and delays by mean + jitter * t / 8192, where
t is a 16-bit integer. So mean and jitter are chosen here such that the table spans the whole distribution;
tc's own tables cut it at four standard deviations (and need not be installed). Draws are independent: a
model's correlation is lost.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.special import gammaincinv, ndtri

from farhand.common.errors import SpecError
from farhand.common.geometry import Array
from farhand.common.timing.clock import to_ns, to_seconds
from farhand.netem.impairments.delay import MeanSdWord
from farhand.netem.impairments.delay_by_trace import Empirical
from farhand.netem.impairments.gaussian import Gaussian
from farhand.netem.impairments.lognormal import LogNormal
from farhand.netem.impairments.modelled import ModelWord, ProfileWord
from farhand.netem.impairments.pareto import Pareto, standard_pareto
from farhand.netem.impairments.paretonormal import NORMAL_PART, PARETO_PART, ParetoNormal
from farhand.netem.impairments.trace_file import open_trace
from farhand.netem.models.model import DelayModel, Jitter, UniformJitter
from farhand.netem.models.profiles import PROFILES, load_model

SIZE = 4096
_SCALE = 8192
_LARGEST = 32_000


class Table(NamedTuple):
    """A distribution as tc-netem wants it.

    Attributes:
        mean_ns, jitter_ns: of `delay`.
        entries: (SIZE,) numbers of the table; empty where the delay is constant.
    """

    mean_ns: int
    jitter_ns: int
    entries: tuple[int, ...]

    def text(self) -> str:
        """What the file holds."""
        return "\n".join(map(str, self.entries)) + "\n"


def table_of(delays: Array) -> Table:
    """The table of a distribution; `delays` holds its quantiles at (i + 1/2) / SIZE (s)."""
    delays = np.maximum(np.asarray(delays, dtype=float), 0.0)
    low, high = float(delays.min()), float(delays.max())
    mean, half = (low + high) / 2, (high - low) / 2
    if half == 0.0:
        return Table(to_ns(mean), 0, ())
    entries = np.rint((delays - mean) / half * _LARGEST).astype(int)
    return Table(to_ns(mean), to_ns(half * _SCALE / _LARGEST), tuple(entries.tolist()))


def probabilities() -> Array:
    """(SIZE,) where the quantiles are taken."""
    return (np.arange(SIZE) + 0.5) / SIZE


def mean_sd_table(word: MeanSdWord) -> Table:
    """The quantiles of a delay with a mean and a standard deviation; raises SpecError where it has no table."""
    if word.sd_ns == 0:
        return Table(word.mean_ns, 0, ())
    made = _MEAN_SD.get(type(word))
    if made is None:
        raise SpecError(f"--backend tc: {word.text()}: has no table; use --backend message")
    return made(word)


def _gaussian(word: MeanSdWord) -> Table:
    """Within four deviations, so that `tc` shows mean and deviation as they are."""
    entries = np.rint(_SCALE * ndtri(probabilities())).astype(int)
    return Table(word.mean_ns, word.sd_ns, tuple(entries.tolist()))


def _lognormal(word: MeanSdWord) -> Table:
    spread = math.log1p((word.sd_ns / word.mean_ns) ** 2)
    quantiles = np.exp(math.sqrt(spread) * ndtri(probabilities()) - spread / 2)
    return table_of(to_seconds(word.mean_ns) * quantiles)


def _pareto(word: MeanSdWord) -> Table:
    return table_of(to_seconds(word.mean_ns) + to_seconds(word.sd_ns) * _pareto_quantiles())


def _paretonormal(word: MeanSdWord) -> Table:
    normal, pareto = ndtri(probabilities()[::8])[:, None], _pareto_quantiles()[None, :]
    sums = NORMAL_PART * normal + PARETO_PART * pareto
    return table_of(to_seconds(word.mean_ns) + to_seconds(word.sd_ns) * np.quantile(sums, probabilities()))


def _pareto_quantiles() -> Array:
    return np.array([standard_pareto(1 - p) for p in probabilities()])


_MEAN_SD: dict[type[MeanSdWord], Callable[[MeanSdWord], Table]] = {
    Gaussian: _gaussian,
    LogNormal: _lognormal,
    Pareto: _pareto,
    ParetoNormal: _paretonormal,
}


def empirical_table(word: Empirical, direction: str) -> Table:
    """The quantiles of a recording's delays in one direction; raises TraceError."""
    delays = open_trace(word.path, word.options).delays_of(direction)
    return table_of(np.quantile(delays[~np.isnan(delays)], probabilities()))


def model_of(word: ProfileWord | ModelWord) -> DelayModel:
    """The model that a word names; raises TraceError, or SpecError where it has episodes."""
    model = PROFILES[word.profile].model if isinstance(word, ProfileWord) else load_model(word.path).model
    if model.episodes:
        raise SpecError(
            f"--backend tc: {word.text()} has stalls or outages, which tc-netem cannot make; use --backend message"
        )
    return model


def model_table(model: DelayModel) -> Table:
    """The quantiles of one direction's floor and jitter."""
    halves = 2 if model.path == "round-trip" else 1
    delays = np.full(SIZE, model.floor / halves)
    if isinstance(model.jitter, Jitter):
        delays += model.jitter.scale * gammaincinv(model.jitter.shape / halves, probabilities())
    elif isinstance(model.jitter, UniformJitter):
        delays += model.jitter.width * probabilities()
    return table_of(delays)
