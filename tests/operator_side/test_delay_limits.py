"""Which setting a round trip is too long for, and what would do."""

import math

import pytest

from farhand.laboratory.simulation import simulate
from farhand.operator_side.sensing.delay_limits import beyond_limits
from farhand.runs.scenario import load_scenario, replace_settings


@pytest.mark.parametrize(
    ("rtt", "resync_after", "max_age", "said"),
    [
        (0.7, 0.8, 1.0, ""),
        (0.9, 0.8, 1.0, "longer than operator.resync_after = 0.8 s; 1.5 s would do"),
        (1.3, 2.0, 1.0, "longer than safety.max_age = 1 s; 2 s would do"),
        (1.3, 0.8, 1.0, "operator.resync_after = 0.8 s and safety.max_age = 1 s; 2 s would do"),
        (0.9, math.inf, 1.0, ""),
    ],
)
def test_the_setting_is_named(rtt, resync_after, max_age, said):
    found = beyond_limits(rtt, resync_after, max_age)
    assert said in found
    assert bool(found) == bool(said)


@pytest.mark.parametrize(
    ("delay", "settings", "named"),
    [
        (450, {}, "operator.resync_after = 0.8 s; 1.5 s would do"),
        (650, {"operator.resync_after": 2.0}, "safety.max_age = 1 s; 2 s would do"),
    ],
)
def test_a_run_says_it_and_what_would_do_does(delay, settings, named):
    scenario = replace_settings(load_scenario("point-obstacle"), settings)
    spec = f"constant:{delay}"
    stands = simulate(scenario, uplink=spec, downlink=spec, time_limit=10.0)
    assert named in stands.summary.why
    enough = float(named.split(";")[1].split()[0])
    # A lease is renewed by whatever comes from its holder: it need not be as long as the round trip.
    short = {"safety.lease_timeout": delay * 1e-3, "safety.stop_timeout": delay * 1e-3}
    lets = {"operator.resync_after": enough, "safety.max_age": enough, **short}
    scenario = replace_settings(scenario, lets)
    assert simulate(scenario, uplink=spec, downlink=spec, time_limit=90.0).summary.finished
