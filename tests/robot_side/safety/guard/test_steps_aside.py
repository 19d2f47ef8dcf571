"""Where every way that could be kept to meets a wall, or the mover, a quick step to the side and a stop is taken."""

import pytest

from farhand.trials.safety.guard import Trial, run_case


@pytest.mark.parametrize("index", [80, 83, 84, 117])
def test_a_box_between_walls_steps_aside(index):
    case = Trial(robots=("box",), speeds=(0.5,)).cases()[index]
    found = run_case(1, case)
    assert not found.error
    assert found.nearest >= 0.01, f"{found.nearest * 1e3:.1f} mm to {found.obstacle}: {found.reason}"
