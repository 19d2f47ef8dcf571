"""Every delay distribution and loss model against its definition, in virtual time, where it is exact."""

import math

import numpy as np
import pytest
from scipy import stats

from farhand.common.link.link import Packet
from farhand.netem.chain import Chain
from farhand.netem.impairments.loss_markov import stationary
from farhand.netem.impairments.paretonormal import NORMAL_PART, PARETO_PART
from farhand.netem.spec import parse_spec
from tests.examples import also

KEY = "farhand/r/state"
N = 20_000


def offer_all(text, count=N, seed=1, interval_ns=2_000_000, size=100, key=KEY):
    chain = Chain(parse_spec(text), seed, "uplink")
    return [
        chain.offer(Packet(key, bytes(size), 1 + n * interval_ns), 1 + n * interval_ns)[0]
        for n in range(count)
    ]


def delays(text, **kwargs):
    return np.array([t.release_ns - t.arrived_ns for t in offer_all(text, **kwargs)]) * 1e-9


def pareto_cdf(x):
    mean, sd = 1.5, math.sqrt(3) / 2
    return stats.pareto(3, loc=0.05 - 0.01 * mean / sd, scale=0.01 / sd).cdf(x)


def lognormal_cdf(x):
    sigma = math.sqrt(math.log1p((20 / 50) ** 2))
    return stats.lognorm(sigma, scale=0.05 * math.exp(-sigma * sigma / 2)).cdf(x)


def paretonormal_cdf(x):
    nodes, weights = np.polynomial.hermite_e.hermegauss(80)
    weights = weights / weights.sum()
    pareto = stats.pareto(3)
    total = np.zeros_like(x)
    for node, weight in zip(nodes, weights, strict=True):
        rest = ((x - 0.2) / 0.02 - NORMAL_PART * node) / PARETO_PART
        total += weight * pareto.cdf(rest * math.sqrt(3) / 2 + 1.5)
    return total


DISTRIBUTIONS = {
    "uniform:50,200": stats.uniform(0.05, 0.15).cdf,
    "gaussian:200,20": stats.norm(0.2, 0.02).cdf,
    "pareto:50,10": pareto_cdf,
    "paretonormal:200,20": paretonormal_cdf,
    "lognormal:50,20": lognormal_cdf,
}


@pytest.mark.parametrize("text", DISTRIBUTIONS)
def test_distribution_is_the_one_asked_for(text):
    assert stats.kstest(delays(text), DISTRIBUTIONS[text]).pvalue > 0.01


@pytest.mark.parametrize("text", DISTRIBUTIONS)
def test_a_wrong_distribution_is_found_out(text):
    """The bound is sharp: 2% more delay fails it."""
    assert stats.kstest(delays(text) * 1.02, DISTRIBUTIONS[text]).pvalue < 0.01


@pytest.mark.parametrize(
    ("text", "correlation"),
    [
        *((text, 0.25) for text in DISTRIBUTIONS),
        ("gaussian:200,20", 0.9),
        *(also(text, 0.9) for text in DISTRIBUTIONS if not text.startswith("gaussian")),
    ],
)
def test_correlation_leaves_the_distribution(text, correlation):
    """Every 60th message is as good as independent: 0.9^60 = 0.002."""
    found = delays(f"{text},{correlation * 100:g}%", count=180_000 if correlation > 0.5 else 40_000)
    thinned = found[:: 60 if correlation > 0.5 else 8]
    assert stats.kstest(thinned, DISTRIBUTIONS[text]).pvalue > 0.01
    if text.startswith("gaussian"):
        assert abs(np.corrcoef(found[:-1], found[1:])[0, 1] - correlation) < 3 / math.sqrt(len(found))


def test_constant_is_exact():
    assert set(delays("constant:12.345678", count=100)) == {0.012345678}


def test_gaussian_below_zero_becomes_zero():
    transits = offer_all("gaussian:20,20")
    found = np.array([t.delay_ns for t in transits]) * 1e-9
    zero = float(np.mean(found == 0))
    p = stats.norm.cdf(-1)
    assert abs(zero - p) < 3 * math.sqrt(p * (1 - p) / N)
    expected = 0.02 * stats.norm.cdf(1) + 0.02 * stats.norm.pdf(1)
    assert abs(found.mean() - expected) < 3 * found.std() / math.sqrt(N)


def test_empirical_draws_the_recorded_delays(tmp_path):
    file = tmp_path / "slots.txt"
    file.write_text("".join(f"{10 + n % 7}\n" for n in range(70)))
    found = delays(f"empirical:{file},period=10,kind=one-way", count=7000)
    assert set(np.round(found, 9)) == {round((10 + n) * 1e-3, 9) for n in range(7)}
    assert stats.chisquare(np.unique(found, return_counts=True)[1]).pvalue > 0.01


def test_trace_replays_by_time_for_all_keys(tmp_path):
    file = tmp_path / "slots.txt"
    file.write_text("".join(f"{n + 1}\n" for n in range(100)))
    found = delays(f"trace:{file},period=10,kind=one-way", count=100, interval_ns=10_000_000)
    assert np.allclose(found, np.arange(1, 101) * 1e-3)
    chain = Chain(parse_spec(f"trace:{file},period=10,kind=one-way"), 1, "uplink")
    chain.start(1)
    late = chain.offer(Packet("farhand/r/camera/a", b"", 500_000_001), 500_000_001)[0]
    assert late.delay_ns == 51_000_000


def burst_lengths(lost):
    edges = np.diff(np.concatenate([[0], lost.astype(int), [0]]))
    return np.flatnonzero(edges == -1) - np.flatnonzero(edges == 1)


def block_error(values, blocks=100):
    """Standard error of a mean of correlated values, from blocks."""
    means = np.array([block.mean() for block in np.array_split(values, blocks)])
    return means.std(ddof=1) / math.sqrt(blocks)


@pytest.mark.parametrize(
    ("text", "rate", "burst"),
    [
        ("loss:5%", 0.05, 1 / 0.95),
        ("loss:5%,60%", 0.05, None),
        ("loss:gilbert(1%,10%)", 0.01 / 0.11, 10.0),
        ("loss:gilbert(5%,25%,80%,1%)", (0.05 * 0.8 + 0.25 * 0.01) / 0.30, None),
        ("loss:state(2%)", 0.02 / 1.0, 1.0204081632653061),
        ("loss:state(1%,20%,10%,30%,0.5%)", None, None),
    ],
)
def test_loss_rate_and_burst_length(text, rate, burst):
    lost = np.array([bool(t.cause) for t in offer_all(text, count=60_000)])
    if rate is None:
        matrix = np.array([[0.985, 0, 0.01, 0.005], [0, 0.7, 0.3, 0], [0.2, 0.1, 0.7, 0], [1.0, 0, 0, 0]])
        rate = stationary(matrix)[2:].sum()
    if text == "loss:state(2%)":
        rate = stationary(np.array([[0.98, 0, 0.02, 0], [0, 0, 1, 0], [0.98, 0, 0.02, 0], [1, 0, 0, 0]]))[
            2:
        ].sum()
    assert abs(lost.mean() - rate) < 3 * block_error(lost)
    if burst is not None:
        lengths = burst_lengths(lost)
        assert abs(lengths.mean() - burst) < 3 * lengths.std() / math.sqrt(len(lengths)) + 1e-9


def test_correlated_losses_come_in_bursts():
    alone = burst_lengths(np.array([bool(t.cause) for t in offer_all("loss:5%")])).mean()
    together = burst_lengths(np.array([bool(t.cause) for t in offer_all("loss:5%,80%")])).mean()
    assert together > 1.5 * alone


def test_loss_by_trace(tmp_path):
    file = tmp_path / "trace.csv"
    file.write_text("delay(ms)\n" + "".join("nan\n" if n % 4 == 0 else "5\n" for n in range(40)))
    lost = [bool(t.cause) for t in offer_all(f"loss:trace({file},kind=one-way)", count=40)]
    assert lost == [n % 4 == 0 for n in range(40)]


def test_in_order_delivery_changes_the_distribution():
    """125 Hz, gaussian:50,20: 61.9 +- 14.3 ms instead of 50 +- 20."""
    found = delays("gaussian:50,20 reorder:in-order", interval_ns=8_000_000, count=60_000)
    assert abs(found.mean() - 0.0619) < 0.0003
    assert abs(found.std() - 0.0143) < 0.0003
