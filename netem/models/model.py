"""A seeded model of a network's delay: a floor, jitter that is correlated in time, episodes, and loss.

    delay(t) = floor + jitter(t)                      without an episode
             + extra                                  in a "slow" episode (extra drawn once an episode)
    max(delay(t), end of the episode - t)             in a "hold" episode: all arrive in one burst at its end
    lost                                              in a "loss" episode

jitter = Q(Phi(z(t))), Q the quantile function of a gamma (or uniform) distribution, and z an
Ornstein-Uhlenbeck process: corr(z(t), z(t + d)) = exp(-d / correlation_time).

Episodes follow the clock and their own random stream, whatever messages come; jitter and loss take one
draw for each message (sampler.py).

A model of round trips is split in halves. A sum of gamma variables of one scale is gamma with the sum of
their shapes, so each direction takes half of the floor, half of the shape, and every second episode
(twice the interval; the downlink's periodic ones come between the uplink's); what is lost of the round
trips is shared likewise. The sum of one delay each way then is distributed as the model says, save where
random episodes of both directions happen to overlap.
"""

import math
from typing import Annotated, Literal

from msgspec import Meta, Struct

from farhand.netem.recordings.formats.base import Kind

Seconds = Annotated[float, Meta(ge=0, le=3600)]
Positive = Annotated[float, Meta(gt=0, le=86_400)]
EpisodeKind = Literal["slow", "hold", "loss"]


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


def log_uniform_mean(low: float, high: float) -> float:
    """Mean of a log-uniform variable between two positive bounds."""
    return low if high == low else (high - low) / math.log(high / low)
