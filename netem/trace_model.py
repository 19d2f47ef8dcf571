"""A seeded model of a network's delay: a floor, jitter that is correlated in time, episodes, and loss.

    delay(t) = floor + jitter(t)                      without an episode
             + extra                                  in a "slow" episode (extra drawn once an episode)
    max(delay(t), end of the episode - t)             in a "hold" episode: all arrive in one burst at its end
    lost                                              in a "loss" episode

jitter = Q(Phi(z(t))), Q the quantile function of a gamma (or uniform) distribution, and z an
Ornstein-Uhlenbeck process: corr(z(t), z(t + d)) = exp(-d / correlation_time).

Episodes follow the clock and their own random stream, whatever messages come; jitter and loss take one
draw for each message.

A model of round trips is split in halves. A sum of gamma variables of one scale is gamma with the sum of
their shapes, so each direction takes half of the floor, half of the shape, and every second episode
(twice the interval; the downlink's periodic ones come between the uplink's); what is lost of the round
trips is shared likewise. The sum of one delay each way then is distributed as the model says, save where
random episodes of both directions happen to overlap.
"""

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Annotated, Literal

import numpy as np
from msgspec import Meta, Struct
from scipy.special import gammainccinv, gammaincinv, ndtr

from common.clock import NANOSECONDS_PER_SECOND, to_ns
from netem.trace_formats.base import Kind

Seconds = Annotated[float, Meta(ge=0, le=3600)]
Positive = Annotated[float, Meta(gt=0, le=86_400)]
EpisodeKind = Literal["slow", "hold", "loss"]

_Z_LIMIT, _Z_STEPS_PER_UNIT = 6.0, 64


class Jitter(Struct, frozen=True, forbid_unknown_fields=True, tag_field="distribution", tag="gamma"):
    """Gamma-distributed jitter above the floor; mean = shape * scale, variance = shape * scale^2.

    Attributes:
        shape: without unit.
        scale: s.
        correlation_time: after which the correlation has fallen to 1/e (s); 0: independent draws.
    """

    shape: Annotated[float, Meta(gt=0, le=1e6)]
    scale: Annotated[float, Meta(gt=0, le=3600)]
    correlation_time: Seconds = 0.0


class UniformJitter(Struct, frozen=True, forbid_unknown_fields=True, tag_field="distribution", tag="uniform"):
    """Uniform jitter above the floor, one-way models only.

    Attributes:
        width: s.
        correlation_time: see Jitter (s).
    """

    width: Annotated[float, Meta(gt=0, le=3600)]
    correlation_time: Seconds = 0.0


class Episodes(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Times at which the network is not as usual.

    Attributes:
        kind: "slow" adds `extra`, "hold" keeps messages until the end, "loss" loses them.
        interval: mean time from the start of one to the start of the next (s), longer than any episode.
        shortest, longest: duration (s), log-uniform between the two.
        least_extra, most_extra: added delay of a slow episode (s), log-uniform between the two.
        periodic: starts exactly every `interval`, the first after one interval without its longest
            duration; otherwise the times between episodes are exponentially distributed.
    """

    kind: EpisodeKind
    interval: Positive
    shortest: Positive
    longest: Positive
    least_extra: Seconds = 0.0
    most_extra: Seconds = 0.0
    periodic: bool = False

    def __post_init__(self) -> None:
        if not self.shortest <= self.longest < self.interval:
            raise ValueError("episodes need shortest <= longest < interval")
        if self.kind == "slow" and not 0 < self.least_extra <= self.most_extra:
            raise ValueError("slow episodes need 0 < least_extra <= most_extra")

    def mean_duration(self) -> float:
        """Mean of the log-uniform duration (s)."""
        return log_uniform_mean(self.shortest, self.longest)


class DelayModel(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Parameters of the model.

    Attributes:
        path: whether they describe one way or a round trip.
        floor: least delay (s).
        jitter: above the floor; None for none.
        episodes: kinds of episodes, independent of one another.
        loss: fraction of the messages lost outside "loss" episodes.
        loss_burst: mean number of messages lost in a row (Gilbert model); None: independent losses.
    """

    path: Kind
    floor: Seconds
    jitter: Jitter | UniformJitter | None = None
    episodes: tuple[Episodes, ...] = ()
    loss: Annotated[float, Meta(ge=0, lt=1)] = 0.0
    loss_burst: Annotated[float, Meta(ge=1, le=1e6)] | None = None

    def __post_init__(self) -> None:
        if self.path == "round-trip" and isinstance(self.jitter, UniformJitter):
            raise ValueError("uniform jitter cannot be split into directions; use path one-way")
        if self.loss_burst is not None and self.loss / (1 - self.loss) > self.loss_burst:
            raise ValueError("loss_burst is too short for so much loss")

    def sampler(
        self,
        rng: np.random.Generator,
        direction: str,
        *,
        schedule: np.random.Generator | None = None,
        origin_ns: int | None = None,
    ) -> "ModelSampler":
        """The delays of one direction.

        Args:
            rng: for the messages.
            direction: "uplink" or "downlink".
            schedule: for the episodes, so that several samplers can share them; None: derived from `rng`.
            origin_ns: instant that episodes count from; None: the first message.
        """
        return ModelSampler(self, rng, direction, schedule, origin_ns)


class ModelSampler:
    """Draws one direction's delays from a model; see DelayModel.sampler."""

    def __init__(
        self,
        model: DelayModel,
        rng: np.random.Generator,
        direction: str,
        schedule: np.random.Generator | None,
        origin_ns: int | None,
    ) -> None:
        halves = 2 if model.path == "round-trip" else 1
        if schedule is None and model.episodes:
            schedule = np.random.Generator(np.random.PCG64(int(rng.integers(1 << 62))))
        self._floor = model.floor / halves
        self._normal = rng.standard_normal
        self._random = rng.random
        self._quantile: Callable[[float], float] | None = None
        self._correlation_ns = 0.0
        if isinstance(model.jitter, Jitter):
            self._quantile = _Table(_gamma_table(model.jitter.shape / halves), model.jitter.scale)
        elif isinstance(model.jitter, UniformJitter):
            self._quantile = _Table(_uniform_table(), model.jitter.width)
        if model.jitter is not None:
            self._correlation_ns = model.jitter.correlation_time * NANOSECONDS_PER_SECOND
        self._z: float | None = None
        self._last_ns = 0
        loss = 1 - math.sqrt(1 - model.loss) if halves == 2 else model.loss
        # The Gilbert chain: left with 1/burst, entered such that a fraction `loss` of messages is in it.
        self._leave = 1 - loss if model.loss_burst is None else 1 / model.loss_burst
        self._enter = self._leave * loss / (1 - loss)
        self._lossy = loss > 0
        self._losing = False
        self._episodes: list[_Schedule] = []
        if schedule is not None:
            for episodes in model.episodes:
                own = np.random.Generator(np.random.PCG64(int(schedule.integers(1 << 62))))
                self._episodes.append(_Schedule(episodes, own, halves, direction == "downlink"))
        self._origin_ns = origin_ns

    def draw(self, now_ns: int) -> float | None:
        """Delay (s) of the message that enters at `now_ns` (never decreasing); None: it is lost."""
        if self._origin_ns is None:
            self._origin_ns = now_ns
        delay = self._floor
        if self._quantile is not None:
            delay += self._quantile(self._next_z(now_ns))
        lost = False
        if self._lossy:
            chance = self._random()
            self._losing = chance >= self._leave if self._losing else chance < self._enter
            lost = self._losing
        held = 0.0
        for schedule in self._episodes:
            episode = schedule.at(max(0, now_ns - self._origin_ns))
            if episode is None:
                continue
            if schedule.kind == "slow":
                delay += episode[1]
            elif schedule.kind == "hold":
                held = max(held, episode[0] / NANOSECONDS_PER_SECOND)
            else:
                lost = True
        return None if lost else max(delay, held)

    def _next_z(self, now_ns: int) -> float:
        innovation = float(self._normal())
        if self._z is None or self._correlation_ns == 0.0:
            self._z = innovation
        else:
            kept = math.exp(-max(0, now_ns - self._last_ns) / self._correlation_ns)
            self._z = kept * self._z + math.sqrt(1 - kept * kept) * innovation
        self._last_ns = now_ns
        return self._z


class _Schedule:
    """When one kind of episode happens in one direction, drawn as time goes on."""

    def __init__(self, episodes: Episodes, rng: np.random.Generator, halves: int, is_downlink: bool) -> None:
        self.kind = episodes.kind
        self._rng = rng
        self._shortest, self._longest = episodes.shortest, episodes.longest
        self._extras = (episodes.least_extra, episodes.most_extra)
        self._period_ns = to_ns(episodes.interval) * halves if episodes.periodic else 0
        # Random episodes: the time between them makes up the interval.
        self._mean_gap = episodes.interval * halves - episodes.mean_duration()
        first = episodes.interval * (2 if halves == 2 and is_downlink else 1) - episodes.longest
        self._start_ns = to_ns(first) if episodes.periodic else self._gap_ns()
        self._end_ns, self._extra = self._start_ns, 0.0
        self._draw_episode()

    def at(self, since_ns: int) -> tuple[int, float] | None:
        """(time to the end (ns), extra delay (s)) of the episode in force; None if there is none."""
        while since_ns >= self._end_ns:
            self._start_ns = (
                self._start_ns + self._period_ns if self._period_ns else self._end_ns + self._gap_ns()
            )
            self._draw_episode()
        return (self._end_ns - since_ns, self._extra) if since_ns >= self._start_ns else None

    def _gap_ns(self) -> int:
        return to_ns(self._mean_gap * self._rng.standard_exponential())

    def _draw_episode(self) -> None:
        share, extra_share = float(self._rng.random()), float(self._rng.random())
        duration = self._shortest * (self._longest / self._shortest) ** share
        self._end_ns = self._start_ns + max(1, to_ns(duration))
        if self.kind == "slow":
            least, most = self._extras
            self._extra = least * (most / least) ** extra_share


class _Table:
    """A quantile function tabulated over z, linear in between; beyond +-6 the end's value."""

    def __init__(self, values: tuple[float, ...], scale: float) -> None:
        self._values = values
        self._scale = scale

    def __call__(self, z: float) -> float:
        place = (min(max(z, -_Z_LIMIT), _Z_LIMIT) + _Z_LIMIT) * _Z_STEPS_PER_UNIT
        index = min(int(place), len(self._values) - 2)
        low, high = self._values[index], self._values[index + 1]
        return self._scale * (low + (place - index) * (high - low))


@lru_cache(maxsize=32)
def _gamma_table(shape: float) -> tuple[float, ...]:
    z = np.arange(-_Z_LIMIT, _Z_LIMIT + 1e-9, 1 / _Z_STEPS_PER_UNIT)
    # Either tail is computed from its own end, where the probability has full precision.
    values = np.where(z < 0, gammaincinv(shape, ndtr(z)), gammainccinv(shape, ndtr(-z)))
    return tuple(values.tolist())


@lru_cache(maxsize=1)
def _uniform_table() -> tuple[float, ...]:
    z = np.arange(-_Z_LIMIT, _Z_LIMIT + 1e-9, 1 / _Z_STEPS_PER_UNIT)
    return tuple(ndtr(z).tolist())


def log_uniform_mean(low: float, high: float) -> float:
    """Mean of a log-uniform variable between two positive bounds."""
    return low if high == low else (high - low) / math.log(high / low)
