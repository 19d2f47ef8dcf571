"""A controller's problem with sensible defaults."""

from collections.abc import Sequence

import numpy as np

from farhand.operator_side.control.controller import ControlProblem


def problem(
    position: Sequence[float] = (0.0, 0.0, 0.0),
    desired: Sequence[float] = (0.25, 0.0, 0.0),
    centres: Sequence[Sequence[float]] = (),
    radii: Sequence[float] = (),
    velocities: Sequence[float] | Sequence[Sequence[float]] = (0.0, 0.0, 0.0),
    sigma: float | Sequence[float] = 0.0,
    normals: Sequence[Sequence[float]] | None = None,
) -> ControlProblem:
    """One tick's problem, in arrays of its own.

    Args:
        position: start (m).
        desired: velocity (m/s).
        centres: n of three (m).
        radii: n, all that must be kept clear included (m).
        velocities: of the obstacles, one for all or n of three (m/s).
        sigma: the paper's margin, one for all or n (m^2).
        normals: n of three; a unit vector makes a plane of a sphere, zeros leave it one.

    Raises:
        ValueError: there are not as many centres as radii.
    """
    n = len(radii)
    return ControlProblem(
        position=np.array(position, dtype=float),
        desired=np.array(desired, dtype=float),
        centres=np.array(centres, dtype=float).reshape(n, 3),
        radii=np.array(radii, dtype=float),
        velocities=np.zeros((n, 3)) + np.array(velocities, dtype=float),
        sigmas=np.full(n, sigma, dtype=float),
        normals=None if normals is None else np.array(normals, dtype=float).reshape(n, 3),
    )
