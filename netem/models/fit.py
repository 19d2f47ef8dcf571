"""Fit of the delay model (model.py) to a recording.

1. Samples above a threshold beyond the reach of the usual jitter form episodes; so do runs of lost messages.
2. Where most episodes' delays fall as fast as time passes they held their messages, which then arrived
   together: "hold". Otherwise they are "slow". Periodic, if the times between starts differ by less than
   a tenth.
3. The rest gives floor and jitter: the gamma distribution whose 5, 50, 95 and 99 % quantiles come
   nearest (least squares, relative), and the correlation time from its autocorrelation.
"""

import math
from collections.abc import Callable
from pathlib import Path

import msgspec
import numpy as np
import tomli_w
from numpy.typing import NDArray

from farhand.common.errors import TraceError
from farhand.common.result_file import write_whole
from farhand.common.timing.clock import to_ns
from farhand.netem.models.model import DelayModel, EpisodeKind, Episodes, Jitter, log_uniform_mean
from farhand.netem.models.sampler import ModelSampler
from farhand.netem.recordings.trace import Trace

FITTED = (5.0, 50.0, 95.0, 99.0)
BULK = (5.0, 25.0, 50.0, 75.0)
"""Percentiles that episodes hardly touch."""
MIN_SAMPLES = 100
_LOSS_RUN = 3
"""So many messages lost in a row are an episode."""


def fit_model(trace: Trace) -> DelayModel:
    """The model nearest to a recording; raises TraceError if it is too short or its samples have no times."""
    if trace.duration is None:
        raise TraceError("trace: a fit needs the times or the period of the samples; give the period")
    delays: NDArray[np.float64] = trace.recorded
    arrived = ~np.isnan(delays)
    if arrived.sum() < MIN_SAMPLES:
        raise TraceError(f"trace: {int(arrived.sum())} delays are too few for a fit; at least {MIN_SAMPLES}")
    times = trace.times
    if times is None:
        times = np.arange(len(delays), dtype=np.float64) * (trace.period or 0.0)
    step = trace.duration / len(delays)
    threshold = _threshold(delays[arrived])
    high = arrived & (np.nan_to_num(delays) > threshold)
    usual = float(np.median(delays[arrived]))
    # A message lost within an episode does not end it.
    runs = _runs(high | (~arrived & _last_of(high, arrived) & _last_of(high[::-1], arrived[::-1])[::-1]))
    # Two samples show no slope: the episodes that do decide for all.
    falling = [_falls(times[a : b + 1], delays[a : b + 1]) for a, b in runs if b - a >= 2]
    high_kind: EpisodeKind = "hold" if 2 * sum(falling) > len(falling) else "slow"
    by_kind: dict[EpisodeKind, list[tuple[float, float, float]]] = {"slow": [], "hold": [], "loss": []}
    inside, lost_runs = np.zeros(len(delays), dtype=bool), np.zeros(len(delays), dtype=bool)
    for first, last in runs:
        inside[first : last + 1] = True
        held = float(np.nanmax(delays[first : last + 1]))
        duration = held if high_kind == "hold" else float(times[last] - times[first]) + step
        extra = float(np.nanmedian(delays[first : last + 1])) - usual
        by_kind[high_kind].append((float(times[first]), duration, max(extra, 1e-6)))
    for first, last in _runs(~arrived):
        if last - first + 1 >= _LOSS_RUN:
            inside[first : last + 1] = lost_runs[first : last + 1] = True
            by_kind["loss"].append((float(times[first]), float(times[last] - times[first]) + step, 0.0))
    episodes = tuple(
        found
        for kind, events in by_kind.items()
        if events and (found := _episodes(kind, events, trace.duration)) is not None
    )
    body = delays[arrived & ~inside]
    if len(body) < MIN_SAMPLES // 2:
        raise TraceError("trace: nearly all of it is episodes; there is no usual delay to fit")
    # Single losses go on in stalls, here as in the model; only a loss episode has none of its own.
    single_loss = float((~arrived & ~lost_runs).sum()) / max(1, int((~lost_runs).sum()))
    floor, jitter = _jitter(body, _correlation_time(np.where(inside, np.nan, delays), step))
    return DelayModel(path=trace.kind, floor=floor, jitter=jitter, episodes=episodes, loss=single_loss)


def save_model(model: DelayModel, path: str | Path, description: str) -> None:
    """Write a model as TOML; raises TraceError if the file cannot be written."""
    content = {
        "description": " ".join(description.split()),
        "model": _without_none(msgspec.to_builtins(model)),
    }
    try:
        write_whole(Path(path), tomli_w.dumps(content))
    except OSError as error:
        raise TraceError(f"model {path}: cannot be written: {error.strerror}") from None


def model_quantiles(
    model: DelayModel,
    percents: tuple[float, ...],
    make_rng: Callable[[str], np.random.Generator],
    step: float,
) -> tuple[dict[float, float], float]:
    """Quantiles (s) of the model's delays, of the sum of both directions if it describes round trips, and its loss.

    Args:
        model: to draw from.
        percents: which quantiles.
        make_rng: the stream of each direction.
        step: time between messages (s).
    """
    step_ns, count = max(1, to_ns(step)), 100_000
    total = np.zeros(count)
    for direction in ("uplink", "downlink") if model.path == "round-trip" else ("uplink",):
        sampler = ModelSampler(model, make_rng(direction), direction)
        drawn = (sampler.draw(index * step_ns) for index in range(count))
        total += np.array([math.nan if delay is None else delay for delay in drawn])
    arrived = total[~np.isnan(total)]
    if not len(arrived):
        return dict.fromkeys(percents, math.nan), 1.0
    quantiles = {percent: float(np.percentile(arrived, percent)) for percent in percents}
    return quantiles, float(np.isnan(total).mean())


def _threshold(arrived: NDArray[np.float64]) -> float:
    """Above it a delay is an episode: out of reach for jitter of the form that the bulk has (s)."""
    from scipy.special import gammainccinv

    median, p75, p95 = (float(value) for value in np.percentile(arrived, [50, 75, 95]))
    spread = max(min(p95 - median, 3.0 * (p75 - median)), 0.05 * median, 1e-4)
    threshold = median + 3.0 * spread
    # The more samples, the farther the usual jitter reaches: what it passes once in ten recordings.
    floor, jitter = _jitter(arrived, 0.0, BULK)
    if jitter is not None:
        reach = floor + jitter.scale * float(gammainccinv(jitter.shape, 0.1 / len(arrived)))
        threshold = max(threshold, reach)
    return threshold


def _last_of(high: NDArray[np.bool_], arrived: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """For each sample, whether the latest that arrived up to it was high."""
    latest = np.maximum.accumulate(np.where(arrived, np.arange(len(high)), 0))
    return high[latest]


def _runs(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """(first, last) index of each run of True."""
    edges = np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8))
    return list(
        zip(np.nonzero(edges == 1)[0].tolist(), (np.nonzero(edges == -1)[0] - 1).tolist(), strict=True)
    )


def _falls(times: NDArray[np.float64], delays: NDArray[np.float64]) -> bool:
    """Whether the delays fall about as fast as time passes, as those of messages held together do."""
    times, delays = times[~np.isnan(delays)], delays[~np.isnan(delays)]
    return len(times) > 1 and times[-1] > times[0] and bool(np.polyfit(times - times[0], delays, 1)[0] < -0.5)


def _episodes(
    kind: EpisodeKind, events: list[tuple[float, float, float]], duration: float
) -> Episodes | None:
    from scipy.optimize import brentq

    starts = np.sort(np.array([event[0] for event in events]))
    lengths = np.array([event[1] for event in events])
    between = np.diff(starts)
    periodic = len(starts) >= 4 and float(between.std()) < 0.1 * float(between.mean())
    interval = float(between.mean()) if periodic else duration / len(starts)
    shortest, longest = float(lengths.min()), float(lengths.max())
    mean = float(lengths.mean())
    if longest >= interval or log_uniform_mean(shortest, longest) > 1.5 * mean:
        # One that lasted far longer than the others would make all too long: keep the time they take up.
        longest = brentq(lambda x: log_uniform_mean(shortest, x) - mean, shortest, 1e3 * longest)
    if longest >= interval:
        return None
    extras = [event[2] for event in events] if kind == "slow" else [0.0]
    return Episodes(
        kind=kind,
        interval=float(f"{interval:.6g}"),
        shortest=float(f"{shortest:.6g}"),
        longest=float(f"{longest:.6g}"),
        least_extra=float(f"{min(extras):.6g}"),
        most_extra=float(f"{max(extras):.6g}"),
        periodic=periodic,
    )


def _jitter(
    body: NDArray[np.float64], correlation_time: float, percents: tuple[float, ...] = FITTED
) -> tuple[float, Jitter | None]:
    from scipy.optimize import minimize
    from scipy.special import gammaincinv

    wanted = np.percentile(body, percents)
    least = max(float(body.min()), 1e-6)
    if float(body.max()) - least < 1e-7:
        return least, None
    fractions = np.array(percents) / 100

    def parameters(x: NDArray[np.float64]) -> tuple[float, float, float]:
        # Transformed so that the floor stays within half of the least delay and all of it.
        floor = least / 2 + least / 2 / (1 + math.exp(-min(max(float(x[0]), -30.0), 30.0)))
        return floor, math.exp(min(max(float(x[1]), -3.0), 5.0)), math.exp(min(max(float(x[2]), -16.0), 3.0))

    def error(x: NDArray[np.float64]) -> float:
        floor, shape, scale = parameters(x)
        found = floor + scale * gammaincinv(shape, fractions)
        return float((((found - wanted) / wanted) ** 2).sum())

    spread = max(float(body.std()), 1e-6)
    best = min(
        (
            minimize(
                error,
                [start, math.log(shape), math.log(spread / math.sqrt(shape))],
                method="Nelder-Mead",
                options={"maxiter": 4000, "xatol": 1e-6, "fatol": 1e-14},
            )
            for start in (3.0, 0.0)
            for shape in (1.0, 4.0)
        ),
        key=lambda result: float(result.fun),
    )
    floor, shape, scale = (float(f"{value:.6g}") for value in parameters(best.x))
    return floor, Jitter(shape, scale, correlation_time)


def _correlation_time(delays: NDArray[np.float64], step: float) -> float:
    """From the autocorrelation at one sample's distance, as corr = exp(-step / time); s."""
    a, b = delays[:-1], delays[1:]
    both = ~np.isnan(a) & ~np.isnan(b)
    if both.sum() < MIN_SAMPLES // 2 or a[both].std() == 0 or b[both].std() == 0:
        return 0.0
    rho = float(np.corrcoef(a[both], b[both])[0, 1])
    return 0.0 if rho <= 0.05 else float(f"{-step / math.log(min(rho, 0.999)):.4g}")


def _without_none(value: object) -> object:
    if isinstance(value, dict):
        return {key: _without_none(item) for key, item in value.items() if item is not None}
    if isinstance(value, list | tuple):
        return [_without_none(item) for item in value]
    return value
