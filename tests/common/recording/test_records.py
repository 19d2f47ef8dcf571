"""What a recording says of its run."""

import pytest

from farhand.common.recording.records import RunInfo


def of(scenario):
    return RunInfo(scenario=scenario, robot="r", session=1, seed=0, versions={})


@pytest.mark.parametrize(
    ("scenario", "period", "kept"),
    [
        ({"controller": {"period": 0.1, "d_min": 0.01}}, 0.1, 0.01),
        ({"controller": {"period": 0.1}, "operator": {"rate_hz": 50.0}}, 0.02, None),
        ({"controller": {"period": 0.1}, "operator": {"rate_hz": 0}}, 0.1, None),
        ({"controller": "x"}, None, None),
        ({}, None, None),
    ],
)
def test_the_period_is_that_of_the_ticks_and_not_of_the_plans_steps(scenario, period, kept):
    assert (of(scenario).tick_period, of(scenario).kept) == (period, kept)
