"""Steers to do harm: straight at an obstacle, the nearest one or another, as fast as it may, and never stops asking."""

from dataclasses import replace
from typing import Annotated, ClassVar

import numpy as np
from msgspec import Meta

from farhand.common.geometry import Array, to_vector3
from farhand.common.messages.base import Positive, Vector3
from farhand.common.scenario.section import Section
from farhand.common.seeds import stream
from farhand.common.shapes.distance import distance_to
from farhand.common.shapes.obstacle import Obstacle, moved
from farhand.operator_side.steering.device import SteeringDevice, SteeringInput, View
from farhand.operator_side.steering.tester.tester import Tester, TesterSettings

SPAN = (0.5, 2.0)
"""For so long one obstacle is driven at (s)."""
NEAREST = 0.6
"""How often that is the nearest one."""
TIP = 1e-4
"""Of the differences from which the way to an obstacle is taken (m)."""


class HostileSettings(Section, frozen=True, kw_only=True):
    """Attributes:
    seed: of what it chooses.
    speed: that it asks for (m/s).
    duration: after which it has done enough (s).
    """

    seed: Annotated[int, Meta(ge=0)] = 0
    speed: Positive = 0.5
    duration: Positive = 20.0


class Hostile(SteeringDevice):
    """See the module's docstring. Acknowledges stops as the tester does."""

    Settings: ClassVar[type[Section]] = HostileSettings
    acknowledges_itself: ClassVar[bool] = True

    def __init__(self, settings: HostileSettings) -> None:
        super().__init__(settings)
        self._own = settings
        self._draw = stream(settings.seed, "hostile")
        self._hand = Tester(TesterSettings())
        self._began_ns: int | None = None
        self._until_ns = 0
        self._chosen: str | None = None

    def read(self, view: View) -> SteeringInput:
        """See SteeringDevice."""
        plain = self._hand.read(view)
        if view.driving and self._began_ns is None:
            self._began_ns = view.now_ns
        if self._began_ns is not None and (view.now_ns - self._began_ns) * 1e-9 >= self._own.duration:
            self.over = True
        return replace(plain, velocity=self._velocity(view), engaged=True)

    def _velocity(self, view: View) -> Vector3:
        age = (view.state.t_sample_ns - view.scene.t_sample_ns) * 1e-9
        obstacles = [moved(o, age) for o in view.scene.obstacles]
        if not obstacles:
            return (0.0, 0.0, 0.0)
        if view.now_ns >= self._until_ns:
            self._until_ns = view.now_ns + round(float(self._draw.uniform(*SPAN)) * 1e9)
            others = self._draw.random() >= NEAREST
            self._chosen = obstacles[int(self._draw.integers(len(obstacles)))].id if others else None
        position = np.array(view.state.position)
        victim = next((o for o in obstacles if o.id == self._chosen), None)
        if victim is None:
            victim = min(obstacles, key=lambda o: distance_to(o, to_vector3(position.tolist())))
        return to_vector3((self._own.speed * _towards(victim, position)).tolist())


def _towards(obstacle: Obstacle, position: Array) -> Array:
    """(3,) the way down the distance from a position (m), of length 1; zero where there is none."""
    slope = np.zeros(3)
    for axis in range(3):
        tip = np.zeros(3)
        tip[axis] = TIP
        ahead, behind = (to_vector3((position + sign * tip).tolist()) for sign in (1.0, -1.0))
        slope[axis] = distance_to(obstacle, behind) - distance_to(obstacle, ahead)
    length = float(np.linalg.norm(slope))
    return slope / length if length > 0.0 else slope
