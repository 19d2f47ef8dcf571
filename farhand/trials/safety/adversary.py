"""Commands that are chosen to do harm: what a broken operator, or an enemy who holds control, may send.

Each gives the tool's twist as one array, linear over angular (6,), m/s and rad/s, a tick at a time.
"""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from farhand.common.geometry import Array

MODES = ("nearest", "random", "bang-bang", "stale", "garbage")
Towards = Callable[[], Array]
"""The twist that brings the robot straight to what is nearest to it, of length 1 or so."""


class Adversary:
    """Args:
    mode: one of MODES: `nearest` drives at the nearest obstacle with the nearest part, `random` somewhere for a
        while, `bang-bang` at the limit of every axis to and fro, `stale` at what was nearest a second or two
        ago, `garbage` something else at every tick.
    rng: of this run.
    linear, angular: limits in each axis (m/s, rad/s).
    towards: see Towards.
    dt: of a tick (s).
    """

    def __init__(
        self, mode: str, rng: Generator, linear: float, angular: float, towards: Towards, dt: float
    ) -> None:
        self._mode, self._rng, self._towards, self._dt = mode, rng, towards, dt
        self._most = np.array([linear] * 3 + [angular] * 3)
        self._left = 0.0
        self._twist = np.zeros(6)
        self._speed = 1.0

    def command(self) -> Array:
        """(6,) for the tick that begins now."""
        self._left -= self._dt
        if self._mode == "garbage":
            return self._garbage()
        if self._left <= 0.0:
            self._choose()
        if self._mode == "nearest":
            return self._limited(self._towards())
        return self._twist

    def _choose(self) -> None:
        rng = self._rng
        self._speed = float(rng.choice([0.1, 0.3, 1.0, 1.0]))
        if self._mode == "random":
            self._left = float(rng.uniform(0.05, 1.0))
            self._twist = self._speed * self._most * rng.uniform(-1.0, 1.0, 6)
        elif self._mode == "bang-bang":
            self._left = float(rng.uniform(0.02, 0.6))
            self._twist = self._most * rng.choice([-1.0, 1.0], 6)
        else:
            self._left = float(rng.uniform(0.5, 2.0))
            self._twist = self._limited(self._towards())

    def _limited(self, twist: Array) -> Array:
        """As fast as the limits and the speed of the moment allow."""
        over = float(np.max(np.abs(twist) / self._most))
        scaled: Array = twist * (self._speed / over) if over > 1e-9 else np.zeros(6)
        return scaled

    def _garbage(self) -> Array:
        rng = self._rng
        kind = rng.integers(4)
        if kind == 0:
            return np.zeros(6)
        if kind == 1:
            return self._limited(self._towards())
        sign: Array = self._most * (rng.choice([-1.0, 1.0], 6) if kind == 2 else rng.uniform(-1.0, 1.0, 6))
        return sign
