"""The capsule of least volume around a body.

Given its axis (a line), and a radius r that is at least the largest distance of a ball's far side from it, the
capsule's ends follow: a ball with its centre at height t, distance d from the line and radius c lies inside
iff the segment reaches to within sqrt((r - c)^2 - d^2) of t. That leaves five unknowns: two angles and two shifts
of the line, and what r has more than it must. They are searched by the simplex method from the principal axes.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize

from farhand.common.geometry import Array
from farhand.robot_side.arm.fitting.body import Body

STEP = 1e-5
"""To which capsules are rounded (m), the radius upwards."""


@dataclass(frozen=True, slots=True)
class Capsule:
    """All points within `radius` (m) of the segment from `a` to `b`, (3,) each (m)."""

    a: Array
    b: Array
    radius: float

    @property
    def volume(self) -> float:
        """In m^3."""
        length = float(np.linalg.norm(self.b - self.a))
        return float(np.pi * self.radius**2 * (length + 4.0 / 3.0 * self.radius))

    def outside(self, body: Body) -> float:
        """How far the ball that sticks out most sticks out (m); negative: all lie inside."""
        return float(np.max(self.distances(body.points) + body.radii) - self.radius)

    def distances(self, points: Array) -> Array:
        """(m,) distances of points (m, 3) from the segment (m)."""
        along = self.b - self.a
        squared = float(along @ along)
        share = (
            np.clip((points - self.a) @ along / squared, 0.0, 1.0) if squared > 0.0 else np.zeros(len(points))
        )
        distances: Array = np.linalg.norm(points - self.a - share[:, None] * along, axis=1)
        return distances


def fit(body: Body) -> Capsule:
    """The smallest capsule found around a body; every ball lies inside it."""
    body = body.hull()
    centre = (body.points.max(axis=0) + body.points.min(axis=0)) / 2.0
    points = body.points - centre
    size = float(np.max(np.linalg.norm(points, axis=1) + body.radii))
    axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=True)[2]
    searches = [
        _Search(points, body.radii, np.roll(axes, shift, axis=0), size, np.zeros(5)) for shift in range(3)
    ]
    best = min((search.searched() for search in searches), key=lambda search: search.volume(search.x))
    best = best.searched().searched()  # begun anew: the simplex may have collapsed short of the least
    found = best.capsule(best.x)
    return _rounded(Capsule(found.a + centre, found.b + centre, found.radius), body)


def _rounded(capsule: Capsule, body: Body) -> Capsule:
    a, b = (np.round(end / STEP) * STEP for end in (capsule.a, capsule.b))
    radius = capsule.radius + Capsule(a, b, capsule.radius).outside(body)
    return Capsule(a, b, float(np.ceil(radius / STEP + 1e-6) * STEP))


@dataclass(frozen=True, slots=True)
class _Search:
    """Attributes:
    points, radii: the balls (m, 3), (m,).
    frame: (3, 3) rows: two directions across the axis at which the search begins, and that axis last.
    size: scale of the unknowns (m).
    x: (5,) where the search begins, or where it ended.
    """

    points: Array
    radii: Array
    frame: Array
    size: float
    x: Array

    def searched(self) -> "_Search":
        options = {"maxiter": 1000, "xatol": 1e-5, "fatol": 1e-7}
        return replace(self, x=minimize(self.volume, self.x, method="Nelder-Mead", options=options).x)

    def volume(self, x: Array) -> float:
        return self.capsule(x).volume / self.size**3

    def capsule(self, x: Array) -> Capsule:
        across, beside, axis = self.frame
        direction = axis + x[0] * across + x[1] * beside
        direction = direction / np.linalg.norm(direction)
        origin = self.size * (x[2] * across + x[3] * beside)
        away = self.points - origin
        heights = away @ direction
        distances = np.linalg.norm(away - heights[:, None] * direction, axis=1)
        radius = float(np.max(distances + self.radii)) + self.size * abs(float(x[4]))
        reach = np.sqrt(np.maximum((radius - self.radii) ** 2 - distances**2, 0.0))
        low, high = float(np.min(heights + reach)), float(np.max(heights - reach))
        if low > high:  # a ball is enough
            low = high = (low + high) / 2.0
        return Capsule(origin + low * direction, origin + high * direction, radius)
