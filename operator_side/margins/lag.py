"""What a lag costs: the barrier binds z = x + lag v, and the body x cuts the corner that z goes round.

For a robot that follows velocity commands with a first-order lag, dz/dt = u and dx/dt = (z - x) / lag: the body
heads for z at every instant. It is therefore always on the inside of z's curve. Let z go round an obstacle on a
circle of radius R at speed V, and the body, once settled, at radius R0 with the same angular speed V / R. It goes
at V R0 / R, at right angles to its radius, and z lies lag times that ahead of it, so that by Pythagoras

    R^2 = R0^2 + (lag V R0 / R)^2,

whose positive root is

    R^2 = (R0^2 + sqrt(R0^4 + 4 R0^2 (lag V)^2)) / 2,    R - R0 = (lag V)^2 / 2 R0 - ... for small lag V.

So a body that shall keep R0 needs R for its z. On the straight and at rest the body keeps more than that; when z
stops, the body runs straight to it, at right angles to its radius or outwards. A path that bends less than the
circle needs less. A path that comes in from farther out and bends round may, before it settles, take the body
deeper than the circle does, where lag V is as large as R: 2 of 1000 random tasks. What no radius pays for, the
check in operator_side/control/checks/body.py stops.
"""

import numpy as np

from farhand.common.geometry import Array


def radii_for_lag(radii: Array, trails: Array) -> Array:
    """What z must keep from each obstacle's centre, so that the body keeps `radii`.

    Args:
        radii: (n,) R0, all that the body must keep clear (m); not negative.
        trails: (n,) lag V, how far the body trails behind z on the straight (m).

    Returns (n,) R in m, at least R0 and at most R0 + lag V / 2.
    """
    square = radii * radii
    outer: Array = np.sqrt((square + np.sqrt(square * square + 4.0 * square * trails * trails)) / 2.0)
    return np.maximum(outer, radii)


def trails_that_fit(radii: Array, gaps: Array) -> Array:
    """The other way round: how far the body may trail where z is as near as `gaps`; 0 where it is nearer than `radii`.

    Args:
        radii: (n,) R0 (m).
        gaps: (n,) from each obstacle's centre to z (m).

    Returns (n,) lag V in m: R sqrt(R^2 - R0^2) / R0 with R the gap.
    """
    inner = np.maximum(radii, 1e-6)
    fitting: Array = gaps * np.sqrt(np.maximum(gaps * gaps - inner * inner, 0.0)) / inner
    return fitting
