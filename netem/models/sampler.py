"""Draws from the delay model: message by message, told the time, from seeded streams."""

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from farhand.common.seeds import derived
from farhand.common.timing.clock import NANOSECONDS_PER_SECOND, to_ns
from farhand.netem.models.model import DelayModel, Episodes, Jitter, UniformJitter

_Z_LIMIT, _Z_STEPS_PER_UNIT = 6.0, 64


class ModelSampler:
    """Draws one direction's delays from a model.

    Args:
        model: its parameters.
        rng: for the messages.
        direction: "uplink" or "downlink".
        schedule: for the episodes, so that several samplers can share them; None: derived from `rng`.
        origin_ns: instant that episodes count from; None: the first message.
    """

    def __init__(
        self,
        model: DelayModel,
        rng: np.random.Generator,
        direction: str,
        *,
        schedule: np.random.Generator | None = None,
        origin_ns: int | None = None,
    ) -> None:
        halves = 2 if model.path == "round-trip" else 1
        if schedule is None and model.episodes:
            schedule = derived(rng)
        self._floor = model.floor / halves
        self._normal = rng.standard_normal
        self._random = rng.random
        self._quantile = _quantile(model)
        self._correlation_ns = 0.0
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
                is_downlink = direction == "downlink"
                self._episodes.append(_Schedule(episodes, derived(schedule), halves, is_downlink))
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


def load() -> None:
    """Have ready what all tables are computed with: to import it takes longer than who changes a network waits."""
    _uniform_table()


def prepare(model: DelayModel) -> None:
    """Have ready what a sampler of the model needs: the first takes a while, in which no message would go on."""
    _quantile(model)


def _quantile(model: DelayModel) -> Callable[[float], float] | None:
    if isinstance(model.jitter, Jitter):
        halves = 2 if model.path == "round-trip" else 1
        return _Table(_gamma_table(model.jitter.shape / halves), model.jitter.scale)
    if isinstance(model.jitter, UniformJitter):
        return _Table(_uniform_table(), model.jitter.width)
    return None


@lru_cache(maxsize=32)
def _gamma_table(shape: float) -> tuple[float, ...]:
    from scipy.special import gammainccinv, gammaincinv, ndtr  # here, as most networks need none of it

    z = np.arange(-_Z_LIMIT, _Z_LIMIT + 1e-9, 1 / _Z_STEPS_PER_UNIT)
    # Either tail is computed from its own end, where the probability has full precision.
    values = np.where(z < 0, gammaincinv(shape, ndtr(z)), gammainccinv(shape, ndtr(-z)))
    return tuple(values.tolist())


@lru_cache(maxsize=1)
def _uniform_table() -> tuple[float, ...]:
    from scipy.special import ndtr

    z = np.arange(-_Z_LIMIT, _Z_LIMIT + 1e-9, 1 / _Z_STEPS_PER_UNIT)
    return tuple(ndtr(z).tolist())
