"""The emulated arm goes where the simulated one goes, when both are asked for the same."""

import numpy as np
import pytest

from farhand.trials.ur.drives import ALIKE, apart, apart_in_lockstep


def test_the_distance_of_two_paths_is_that_of_their_places_from_the_others_lines():
    line = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    beside = np.array([[0.2, 0.1, 0.0], [0.5, 0.0, 0.3], [1.4, 0.0, 0.3]])
    assert apart(beside[:1], line) == pytest.approx(0.1)
    assert apart(beside, line) == pytest.approx(0.5)
    assert apart(line, line) == 0.0


@pytest.mark.long
@pytest.mark.slow
def test_asked_for_the_same_twists_the_paths_are_two_millimetres_apart_at_most():
    alike, _, late, _ = apart_in_lockstep("5g-urban", 500.0, seeds=(1,))
    assert 1e-5 < alike <= ALIKE
    assert 1e-5 < late < alike  # one period is less than what a controller takes
