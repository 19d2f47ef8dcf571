"""A robot that answers with another lag than it says is kept as clear, and is as quick."""

import numpy as np
import pytest

from farhand.trials.safety.said_lag import drive


@pytest.mark.parametrize("share", [0.5, 1.5])
def test_a_lag_that_is_wrong_by_half_costs_nothing_that_counts(share):
    right, wrong = (drive("point", 3, "uniform:50,200", each) for each in (1.0, share))
    assert wrong.finished
    assert wrong.clearance > 0.01
    assert wrong.seconds == pytest.approx(right.seconds, rel=0.03)
    assert np.mean(wrong.errors) < np.mean(right.errors) + 0.005
    assert wrong.identified == pytest.approx(0.1, rel=0.1)  # what it has, whatever it says
