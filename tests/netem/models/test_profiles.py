"""The named networks have the moments and quantiles that they claim, and draw alike from the same seed."""

import numpy as np
import pytest

from farhand.common.errors import TraceError
from farhand.common.seeds import stream
from farhand.netem.models.profiles import PROFILES, load_model
from farhand.netem.models.sampler import _gamma_table
from farhand.netem.spec import parse_spec

COUNT = 60_000


def draw(name, direction, count=COUNT, step=0.02, seed=3):
    sampler = PROFILES[name].sampler(stream(seed, direction, name), direction)
    step_ns = round(step * 1e9)
    drawn = [sampler.draw(10**12 + index * step_ns) for index in range(count)]
    return np.array([np.nan if delay is None else delay for delay in drawn])


def round_trips(name, **options):
    return draw(name, "uplink", **options) + draw(name, "downlink", **options)


def test_a_network_that_was_checked_delays_without_computing_first():
    """It may be changed while it runs: what takes long is done before, by whoever asks for the change."""
    _gamma_table.cache_clear()
    parse_spec("5g-urban").prepare()
    draw("5g-urban", "uplink", count=1)
    table = _gamma_table.cache_info()
    assert (table.hits, table.misses) == (1, 1)


def test_lund_stockholm_has_the_published_moments():
    rtt = round_trips("lund-stockholm")
    # Independent draws: four standard errors.
    assert rtt.mean() == pytest.approx(11.61e-3, abs=4 * 3.29e-3 / COUNT**0.5)
    assert rtt.std() == pytest.approx(3.29e-3, rel=0.02)
    jitter = PROFILES["lund-stockholm"].model.jitter
    floor = PROFILES["lund-stockholm"].model.floor
    assert floor + jitter.shape * jitter.scale == pytest.approx(11.61e-3, rel=1e-12)
    assert jitter.shape**0.5 * jitter.scale == pytest.approx(3.29e-3, rel=1e-12)


def test_lund_stockholm_is_the_gamma_distribution_to_a_sharp_bound():
    from scipy.stats import gamma, kstest

    jitter, floor = (getattr(PROFILES["lund-stockholm"].model, name) for name in ("jitter", "floor"))
    expected = gamma(jitter.shape, loc=floor, scale=jitter.scale)
    assert kstest(round_trips("lund-stockholm"), expected.cdf).pvalue > 0.01
    half = gamma(jitter.shape / 2, loc=floor / 2, scale=jitter.scale)
    assert kstest(draw("lund-stockholm", "uplink"), half.cdf).pvalue > 0.01


@pytest.mark.parametrize(
    ("name", "step", "p50", "p99", "longest", "lost"),
    [
        ("5g-urban", 0.055, 0.015, 0.025, 0.269, 0.025),
        ("5g-urban-100hz", 0.016, 0.017, 0.033, 0.282, 0.124),
        ("5g-weak", 0.055, 0.019, 0.283, 0.505, 0.0),
        ("5g-rural", 0.5, 0.028, 10.879, 12.066, 0.0),
        ("oran", 0.5, 0.028, 0.245, 10.361, 0.0),
        ("wifi-moving", 0.5, 0.0049, 0.058, 12.002, 0.0),
    ],
)
def test_round_trips_have_the_measured_quantiles_and_losses(name, step, p50, p99, longest, lost):
    rtt = round_trips(name, step=step, count=150_000)
    assert np.isnan(rtt).mean() == pytest.approx(lost, rel=0.05)
    rtt = rtt[~np.isnan(rtt)]
    assert np.median(rtt) == pytest.approx(p50, rel=0.06)
    if name.startswith("5g-urban"):
        assert np.percentile(rtt, 99) == pytest.approx(p99, rel=0.08)
    else:
        # Stalls make these tails, and are few: the share beyond the measured p99 is the steadier figure.
        assert np.mean(rtt > p99) == pytest.approx(0.01, abs=0.004)
        assert np.percentile(rtt, 99) == pytest.approx(p99, rel=0.25)
    # Each direction alone stays below the measured maximum; overlapping stalls of both may pass it.
    assert np.nanmax(draw(name, "uplink", step=step)) <= longest


def test_starlink_is_as_recorded():
    delay = draw("starlink", "downlink", step=0.01)
    for percent, measured in ((5, 8), (50, 11), (95, 13), (99, 14)):
        assert np.percentile(delay, percent) * 1e3 == pytest.approx(measured, abs=0.8)
    # Slow at each hand-over, 15 s apart.
    slow = np.nonzero(delay > 0.025)[0] * 0.01
    starts = slow[np.concatenate([[True], np.diff(slow) > 1])]
    np.testing.assert_allclose(np.diff(starts), 15.0, atol=0.011)


@pytest.mark.parametrize("percent", [5, 10, 20])
def test_bursty_loss_has_its_rate_and_its_burst_length(percent):
    lost = np.isnan(draw(f"bursty-loss-{percent}", "uplink", count=200_000))
    loss, burst = percent / 100, 5.0
    edges = np.diff(np.concatenate([[0], lost.astype(int), [0]]))
    lengths = np.nonzero(edges == -1)[0] - np.nonzero(edges == 1)[0]
    # Variance of a two-state chain's occupation: loss (1 - loss) (1 + r) / (1 - r) / n, r its eigenvalue.
    r = 1 - 1 / burst - loss / (burst * (1 - loss))
    deviation = (loss * (1 - loss) * (1 + r) / (1 - r) / len(lost)) ** 0.5
    assert lost.mean() == pytest.approx(loss, abs=3 * deviation)
    geometric = (burst * (burst - 1)) ** 0.5
    assert lengths.mean() == pytest.approx(burst, abs=3 * geometric / len(lengths) ** 0.5)


def test_stress_shapes():
    jump = draw("jump", "uplink", count=600)
    np.testing.assert_allclose(jump[:150], 0.02)
    np.testing.assert_allclose(jump[150:300], 0.25)
    np.testing.assert_allclose(jump[300:450], 0.02)
    spikes = draw("spikes", "uplink")
    assert set(np.round(np.unique(spikes), 9)) == {0.02, 0.6}
    assert np.mean(spikes > 0.5) == pytest.approx(0.2 / 3, rel=0.2)
    outages = np.isnan(draw("outages", "downlink", count=1000))
    assert not outages[:400].any()
    assert outages[400:500].all()
    assert outages.mean() == pytest.approx(0.2)
    np.testing.assert_array_equal(outages, np.isnan(draw("outages", "uplink", count=1000)))


@pytest.mark.parametrize("name", PROFILES)
def test_the_same_seed_gives_the_same_delays(name):
    np.testing.assert_array_equal(draw(name, "uplink", count=2000), draw(name, "uplink", count=2000))
    assert np.nanmin(draw(name, "uplink", count=2000)) > 0


def test_episodes_follow_the_clock_and_not_the_messages():
    def stalled(step):
        delay = draw("5g-weak", "uplink", count=round(20 / step), step=step, seed=5)
        return (delay > 0.1)[:: round(0.02 / step)]

    # Twice the messages, the same stalls, but for the first moments of one when jitter decides.
    assert np.mean(stalled(0.02) != stalled(0.01)) < 0.002


def test_held_messages_arrive_together():
    instants = np.arange(COUNT) * 0.005
    arrivals = instants + draw("5g-weak", "uplink", step=0.005)
    held = arrivals - instants > 0.1
    assert held.sum() > 100
    # Each stall lets go of everything at one instant.
    first = np.nonzero(np.diff(held.astype(int)) == 1)[0] + 1
    for start in first[:10]:
        np.testing.assert_allclose(arrivals[start : start + 10], arrivals[start], atol=1e-9)


def test_samplers_may_share_their_episodes():
    profile = PROFILES["5g-weak"]

    def holds(rng_name):
        sampler = profile.sampler(stream(1, rng_name), "uplink", schedule=stream(1, "schedule"), origin_ns=0)
        return np.array([sampler.draw(index * 10**7) for index in range(3000)]) > 0.1

    np.testing.assert_array_equal(holds("state"), holds("scene"))


def test_jitter_keeps_together_for_its_correlation_time():
    delay = draw("5g-urban-100hz", "uplink", step=0.078 / 4, count=20_000)
    usual = delay < 0.1
    pairs = usual[:-4] & usual[4:]
    rank = delay.argsort().argsort().astype(float)
    # A lag of one correlation time: 1/e in the normal domain is about 0.35 in ranks.
    assert np.corrcoef(rank[:-4][pairs], rank[4:][pairs])[0, 1] == pytest.approx(0.352, abs=0.05)


def test_descriptions_are_one_short_line_each():
    for line in (profile.description for profile in PROFILES.values()):
        assert 20 < len(line) <= 110
        assert "\n" not in line


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", "missing required field `model`"),
        ("x = ", "nvalid value"),
        ("x = 1", "x"),
        ('[model]\npath = "both"\nfloor = 0.1', "model.path"),
        ('[model]\npath = "one-way"\nfloor = -0.1', "model.floor"),
        ('[model]\npath = "one-way"\nfloor = nan', "floor"),
        ('[model]\npath = "one-way"\nfloor = 0.1\nloss = 1.0', "model.loss"),
        ('[model]\npath = "one-way"\nfloor = 0.1\n[model.jitter]\ndistribution = "gauss"', "jitter"),
        (
            '[model]\npath = "round-trip"\nfloor = 0.1\n'
            '[model.jitter]\ndistribution = "uniform"\nwidth = 0.1',
            "one-way",
        ),
        (
            '[model]\npath = "one-way"\nfloor = 0.1\n[[model.episodes]]\nkind = "hold"\n'
            "interval = 1.0\nshortest = 2.0\nlongest = 3.0",
            "shortest <= longest < interval",
        ),
    ],
)
def test_a_bad_model_file_is_one_line(tmp_path, content, words):
    path = tmp_path / "m.toml"
    path.write_text(content)
    with pytest.raises(TraceError) as caught:
        load_model(path)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)
