"""The quick answer is never another one than the exact: who starts plainly outside is in no margin."""

import numpy as np

from farhand.common.seeds import stream
from farhand.operator_side.control.barrier import FEW, gaps, reaches, starts_clear
from farhand.operator_side.control.controller import ControlProblem


def test_what_is_told_quickly_is_true():
    rng, clear = stream(1, "clear"), []
    for _ in range(2000):
        n = int(rng.integers(0, 6))
        centres, position = rng.uniform(-1.0, 1.0, (n, 3)), rng.uniform(-1.0, 1.0, 3)
        radii, sigmas = rng.uniform(0.0, 0.6, n), rng.uniform(0.0, 0.2, n)
        if n and rng.random() < 0.3:  # on the very edge
            radii[0] = np.linalg.norm(position - centres[0])
            sigmas[0] = 0.0
        problem = ControlProblem(position, np.zeros(3), centres, radii, np.zeros((n, 3)), sigmas)
        clear.append(starts_clear(problem))
        outside = gaps(problem)[0] - reaches(problem)
        assert not clear[-1] or (outside > 0.0).all()
        assert clear[-1] or (outside < 1e-6).any()
    assert 0.2 < np.mean(clear) < 0.8


def test_it_does_not_speak_of_planes_of_many_or_of_what_is_no_number():
    far, still = np.full((FEW + 1, 3), 9.0), np.zeros((FEW + 1, 3))
    radii = np.ones(FEW + 1)

    def problem(n, position=(0.0, 0.0, 0.0), normals=None):
        return ControlProblem(
            np.array(position), np.zeros(3), far[:n], radii[:n], still[:n], 0.0 * radii[:n], normals
        )

    assert starts_clear(problem(1))
    assert starts_clear(problem(FEW))
    assert not starts_clear(problem(FEW + 1))
    assert not starts_clear(problem(1, (np.nan, 0.0, 0.0)))
    assert not starts_clear(problem(1, normals=np.array([[0.0, 0.0, 1.0]])))
