"""Named networks: seeded models, each of which says what it was fitted to.

"Round trip" models describe the sum of both directions, of which each carries half; how, and what that
holds, is said in model.py. Only three quantiles are known of some recordings (median, 99 %, maximum);
there the jitter has the form measured on 5g-urban, scaled with the median, and the interval between
stalls is the one that puts the 99 % quantile where it was measured. Where the maximum is far beyond that
quantile (oran, wifi-moving), short stalls are taken to make up three quarters of the slowest hundredth,
and outages of seconds the rest.
"""

from dataclasses import dataclass
from pathlib import Path

import msgspec
import numpy as np

from farhand.common.errors import TraceError
from farhand.common.toml import read_toml
from farhand.netem.models.model import DelayModel, Episodes, Jitter, UniformJitter
from farhand.netem.models.sampler import ModelSampler, prepare


@dataclass(frozen=True)
class Profile:
    """A named network.

    Attributes:
        name: as in a network SPEC.
        description: one line: what it is like, and what it was fitted to.
        model: its parameters.
    """

    name: str
    description: str
    model: DelayModel

    def prepare(self) -> None:
        """Have ready what its samplers need."""
        prepare(self.model)

    def sampler(
        self,
        rng: np.random.Generator,
        direction: str,
        *,
        schedule: np.random.Generator | None = None,
        origin_ns: int | None = None,
    ) -> ModelSampler:
        """The delays of one direction; see ModelSampler."""
        return ModelSampler(self.model, rng, direction, schedule=schedule, origin_ns=origin_ns)


# Floor, shape and scale of 5g-urban per second of its median: the form of jitter lent to the others.
_FLOOR, _SHAPE, _SCALE = 0.7012, 3.2225, 0.10185


def _like_urban(median: float, *episodes: Episodes) -> DelayModel:
    jitter = Jitter(_SHAPE, round(_SCALE * median, 7), 0.037)
    return DelayModel(path="round-trip", floor=round(_FLOOR * median, 6), jitter=jitter, episodes=episodes)


def _hold(interval: float, shortest: float, longest: float) -> Episodes:
    return Episodes(kind="hold", interval=interval, shortest=shortest, longest=longest)


def _bursty(percent: int) -> Profile:
    model = DelayModel(
        path="one-way", floor=0.05, jitter=UniformJitter(0.15), loss=percent / 100, loss_burst=5.0
    )
    return Profile(
        f"bursty-loss-{percent}",
        f"stress: uniform 50 to 200 ms a direction; {percent} % lost, 5 messages in a row on average",
        model,
    )


_ALL = (
    Profile(
        "lund-stockholm",
        "fibre over 500 km: RTT 11.61 ms, sd 3.29 ms, the published moments (fitted to them, exactly)",
        # Light in 500 km of fibre and back takes 5 ms; shape and scale then follow from the two moments.
        DelayModel(
            path="round-trip",
            floor=0.005,
            jitter=Jitter((6.61 / 3.29) ** 2, 3.29e-3**2 / 6.61e-3),
        ),
    ),
    Profile(
        "5g-urban",
        "5G in a city, band n78: RTT p50 15, p99 25, stalls to 269 ms, 2.5 % lost; fitted to CICV5G, 20 Hz",
        DelayModel(
            path="round-trip",
            floor=0.011,
            jitter=Jitter(3.2225, 1.5977e-3, 0.0299),
            episodes=(_hold(89.9, 0.067, 0.269),),
            loss=0.02509,
        ),
    ),
    Profile(
        "5g-urban-100hz",
        "the same at 65 Hz: RTT p50 17, p99 33, stalls to 282 ms, 12.4 % lost, most in bursts; fitted to CICV5G",
        DelayModel(
            path="round-trip",
            floor=0.011797,
            jitter=Jitter(2.08274, 3.02555e-3, 0.0766),
            episodes=(
                _hold(51.7, 0.235, 0.282),
                Episodes(kind="loss", interval=0.589696, shortest=0.0470358, longest=0.0877325),
            ),
            loss=0.017225,
        ),
    ),
    Profile(
        "5g-weak",
        "5G, weak to strong signal, band n8: RTT p50 19, p99 283, max 505 ms; fitted to these quantiles",
        _like_urban(0.019, _hold(2.51, 0.05, 0.505)),
    ),
    Profile(
        "5g-rural",
        "5G on the land, band n8: RTT p50 28 ms, 12 s stalls give p99 10.9, max 12.1 s; fitted to these",
        _like_urban(0.028, _hold(110.4, 11.9, 12.066)),
    ),
    Profile(
        "starlink",
        "satellite, one way p50 11, p99 14, +20 to 40 ms at each 15 s hand-over; fitted to LeoCC",
        DelayModel(
            path="one-way",
            floor=0.0035,
            jitter=Jitter(22.801, 0.000305395, 0.0187),
            episodes=(
                Episodes(
                    kind="slow",
                    interval=15.0,
                    shortest=0.02,
                    longest=0.11,
                    least_extra=0.02,
                    most_extra=0.04,
                    periodic=True,
                ),
            ),
        ),
    ),
    Profile(
        "oran",
        "private O-RAN: RTT p50 28, p99 245 ms, stalls of 0.1 to 10.4 s; fitted to the quantiles of a ping",
        _like_urban(0.028, _hold(10.1, 0.1, 0.6), _hold(1504.0, 1.0, 10.361)),
    ),
    Profile(
        "wifi-moving",
        "robot roaming on Wi-Fi: RTT p50 4.9, p99 58 ms, stalls to 12 s; fitted to the recording's quantiles",
        _like_urban(0.0049, _hold(4.93, 0.03, 0.2), _hold(1748.0, 1.0, 12.002)),
    ),
    Profile(
        "jump",
        "stress: 20 ms a direction, 250 ms for 3 s of every 6 s",
        DelayModel(
            path="one-way",
            floor=0.02,
            episodes=(
                Episodes(
                    kind="slow",
                    interval=6.0,
                    shortest=3.0,
                    longest=3.0,
                    least_extra=0.23,
                    most_extra=0.23,
                    periodic=True,
                ),
            ),
        ),
    ),
    Profile(
        "spikes",
        "stress: 20 ms a direction, 600 ms for 0.2 s every 3 s on average, at random",
        DelayModel(
            path="one-way",
            floor=0.02,
            episodes=(
                Episodes(
                    kind="slow",
                    interval=3.0,
                    shortest=0.2,
                    longest=0.2,
                    least_extra=0.58,
                    most_extra=0.58,
                ),
            ),
        ),
    ),
    Profile(
        "outages",
        "stress: 50 ms a direction, everything lost for 2 s of every 10 s",
        DelayModel(
            path="one-way",
            floor=0.05,
            episodes=(Episodes(kind="loss", interval=10.0, shortest=2.0, longest=2.0, periodic=True),),
        ),
    ),
    _bursty(5),
    _bursty(10),
    _bursty(20),
)

PROFILES: dict[str, Profile] = {profile.name: profile for profile in _ALL}


class _ModelFile(msgspec.Struct, forbid_unknown_fields=True):
    model: DelayModel
    description: str = ""


def load_model(path: str | Path) -> Profile:
    """Read a model that `farhand trace fit --out` wrote; raises TraceError that names the key."""
    try:
        found = msgspec.convert(read_toml(path, "model", TraceError), _ModelFile)
    except (msgspec.ValidationError, RecursionError) as error:
        raise TraceError(f"model {path}: {' '.join(str(error).split())}") from None
    return Profile(f"model:{path}", found.description, found.model)
