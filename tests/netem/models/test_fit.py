"""The fit finds what a model was made of, and comes near the quantiles of recordings."""

import numpy as np
import pytest

from farhand.common.errors import TraceError
from farhand.common.seeds import stream
from farhand.netem.models.fit import fit_model, model_quantiles, save_model
from farhand.netem.models.model import DelayModel, Episodes, Jitter
from farhand.netem.models.profiles import PROFILES, load_model
from farhand.netem.models.sampler import ModelSampler
from farhand.netem.recordings.trace import Trace, load_trace
from tests.netem.recordings.samples.places import SAMPLES, measured

STEP = 0.02


def recording(model, count=60_000):
    sampler = ModelSampler(model, stream(4, "recording"), "uplink")
    drawn = [sampler.draw(round(index * STEP * 1e9)) for index in range(count)]
    return Trace(
        np.array([np.nan if d is None else d for d in drawn]), np.arange(count) * STEP, None, "one-way", ""
    )


def test_it_finds_jitter_stalls_and_loss():
    made = DelayModel(
        path="one-way",
        floor=0.02,
        jitter=Jitter(3.0, 0.002, 0.05),
        episodes=(Episodes(kind="hold", interval=20.0, shortest=0.3, longest=0.6),),
        loss=0.02,
    )
    found = fit_model(recording(made))
    assert found.floor == pytest.approx(0.02, rel=0.05)
    assert found.jitter.shape * found.jitter.scale == pytest.approx(0.006, rel=0.15)
    assert found.jitter.correlation_time == pytest.approx(0.05, rel=0.2)
    assert found.loss == pytest.approx(0.02, rel=0.2)
    (episodes,) = found.episodes
    assert episodes.kind == "hold"
    assert episodes.interval == pytest.approx(20.0, rel=0.3)
    assert episodes.shortest == pytest.approx(0.3, rel=0.15)
    assert episodes.longest == pytest.approx(0.6, rel=0.15)


def test_it_tells_periodic_slowness_and_outages_from_stalls():
    made = DelayModel(
        path="one-way",
        floor=0.02,
        jitter=Jitter(3.0, 0.001),
        episodes=(
            Episodes(
                kind="slow", interval=15.0, shortest=0.5, longest=0.5,
                least_extra=0.05, most_extra=0.06, periodic=True,
            ),
            Episodes(kind="loss", interval=60.0, shortest=1.0, longest=2.0),
        ),
    )  # fmt: skip
    found = {episodes.kind: episodes for episodes in fit_model(recording(made)).episodes}
    assert set(found) == {"slow", "loss"}
    assert found["loss"].longest == pytest.approx(2.0, abs=0.3)
    assert not found["loss"].periodic
    assert 0.045 < found["slow"].least_extra <= found["slow"].most_extra < 0.065


def test_a_fitted_model_is_a_network(tmp_path):
    model = fit_model(recording(PROFILES["5g-urban"].model, 20_000))
    path = tmp_path / "fitted.toml"
    save_model(model, path, "of a test")
    loaded = load_model(path)
    assert loaded.model == model
    assert loaded.description == "of a test"
    assert loaded.sampler(stream(0), "uplink").draw(0) > 0
    with pytest.raises(TraceError, match="cannot be written"):
        save_model(model, tmp_path, "")


@pytest.mark.parametrize(
    ("trace", "words"),
    [
        (Trace(np.full(500, 0.1), None, None, "one-way", ""), "needs the times"),
        (Trace(np.full(50, 0.1), None, 0.1, "one-way", ""), "too few"),
    ],
)
def test_what_cannot_be_fitted(trace, words):
    with pytest.raises(TraceError, match=words):
        fit_model(trace)


def test_a_fit_keeps_the_loss_of_short_bursts_beside_a_long_one():
    delays = np.full(20_000, 0.01) + 0.001 * (np.arange(20_000) % 7)
    for start in range(100, 19_000, 40):
        delays[start : start + 4] = np.nan
    delays[5000:5200] = np.nan
    trace = Trace(delays, None, STEP, "one-way", "")
    lost = np.isnan(recording(fit_model(trace)).recorded).mean()
    assert lost == pytest.approx(np.isnan(delays).mean(), rel=0.1)


def test_a_constant_delay_has_no_jitter():
    model = fit_model(Trace(np.full(500, 0.1), None, 0.02, "one-way", ""))
    assert (model.floor, model.jitter, model.episodes, model.loss) == (pytest.approx(0.1), None, (), 0.0)


def quantiles(trace, model):
    """Fitted and recorded (s) by percent."""
    step, recorded = trace.duration / len(trace.recorded), trace.summary()
    fitted, loss = model_quantiles(model, (50, 95, 99), lambda direction: stream(0, direction), step)
    assert loss == pytest.approx(recorded["loss"], rel=0.1)
    return {percent: (delay, recorded[f"p{percent}"]) for percent, delay in fitted.items()}


@pytest.mark.parametrize("path", SAMPLES, ids=lambda path: path.stem)
def test_samples_are_met_and_what_they_were_made_of_is_found(path):
    trace = load_trace(path)
    model = fit_model(trace)
    found = quantiles(trace, model)
    assert set(found) == {50, 95, 99}
    for percent, (fitted, recorded) in found.items():
        assert fitted == pytest.approx(recorded, rel=0.1), percent
    if path.stem.startswith("vehicle"):
        assert model.floor == pytest.approx(0.014, abs=0.0005)
        assert model.jitter.shape * model.jitter.scale == pytest.approx(0.009, rel=0.1)
        assert [episodes.kind for episodes in model.episodes] == ["hold"]
    else:
        assert (model.path, model.episodes) == ("one-way", ())
        assert model.loss == pytest.approx(np.isnan(trace.recorded).mean())


@pytest.mark.parametrize(
    ("file", "profile"),
    [
        ("cicv5g_urban_n78_20hz.txt", "5g-urban"),
        ("cicv5g_urban_n78_100hz.txt", "5g-urban-100hz"),
        ("starlink_oneway_10ms_slots.txt", "starlink"),
    ],
)
def test_recordings_are_met_and_the_profiles_are_their_fits(file, profile):
    trace = load_trace(measured(file))
    model = fit_model(trace)
    for percent, (fitted, recorded) in quantiles(trace, model).items():
        assert fitted == pytest.approx(recorded, rel=0.08), percent
    built_in = PROFILES[profile].model
    assert built_in.floor == pytest.approx(model.floor, rel=0.01)
    assert built_in.jitter.shape == pytest.approx(model.jitter.shape, rel=0.01)
    assert built_in.jitter.scale == pytest.approx(model.jitter.scale, rel=0.01)
    assert [e.kind for e in built_in.episodes] == [e.kind for e in model.episodes]
    assert built_in.loss == pytest.approx(model.loss, rel=0.01)
    for ours, theirs in zip(built_in.episodes, model.episodes, strict=True):
        assert ours.interval == pytest.approx(theirs.interval, rel=0.01)
        assert ours.longest == pytest.approx(theirs.longest, rel=0.01)
