"""A person as a model: sees late, reacts later, overshoots, trembles the more the faster the hand moves.

Crossover model of D. T. McRuer and H. R. Jex, "A review of quasi-linear pilot models", IEEE Trans. Human Factors in
Electronics HFE-8(3), 1967: of a plant that integrates velocities, a person and the plant together are

    w_c exp(-tau s) / s,    so that the hand asks for w_c times the way that is left, as it was seen tau ago,

behind a neuromuscular lag. The gain w_c goes down as the delay grows, so that the phase margin of about 45 degrees is
kept that pilots keep, which leaves an overshoot. The hand's noise is proportional to what it does: C. M. Harris and
D. M. Wolpert, "Signal-dependent noise determines motor planning", Nature 394, 1998. A person walks round what stands
in the way (sidestep.py).
"""

import math
from collections import deque
from dataclasses import replace
from typing import Annotated, ClassVar

import numpy as np
from msgspec import Meta

from farhand.common.geometry import Array, to_vector3
from farhand.common.messages.base import NonNegative, Positive, Vector3
from farhand.common.scenario.section import Section
from farhand.common.seeds import stream
from farhand.operator_side.steering.device import SteeringDevice, SteeringInput, View
from farhand.operator_side.steering.tester.sidestep import Instant, Sidestep
from farhand.operator_side.steering.tester.tester import Tester, TesterSettings

PHASE = math.pi / 4.0
"""w_c times all delays in the loop is at most this (rad): 45 degrees of the 90 that an integrator leaves remain."""
CORRELATION = 0.2
"""Of the noise (s)."""


class PersonSettings(Section, frozen=True, kw_only=True):
    """Attributes:
    seed: of the noise.
    reaction: tau of the person alone, from seeing to moving (s).
    neuromuscular: lag of arm and hand (s).
    crossover: w_c without any delay but the person's own (rad/s).
    speed: of the hand at its fastest (m/s).
    noise: standard deviation over what is asked.
    """

    seed: Annotated[int, Meta(ge=0)] = 0
    reaction: NonNegative = 0.22
    neuromuscular: Positive = 0.1
    crossover: Positive = 2.5
    speed: Positive = 0.5
    noise: NonNegative = 0.15


class Person(SteeringDevice):
    """See the module's docstring. Acknowledges stops as the tester does."""

    Settings: ClassVar[type[Section]] = PersonSettings
    acknowledges_itself: ClassVar[bool] = True

    def __init__(self, settings: PersonSettings) -> None:
        super().__init__(settings)
        self._own = settings
        self._draw = stream(settings.seed, "person")
        self._hand = Tester(TesterSettings())
        self._sidestep = Sidestep()
        self._seen: deque[tuple[int, Array]] = deque()
        self._asked, self._noise = np.zeros(3), np.zeros(3)
        self._loop = 0.0
        self._last_ns: int | None = None

    def read(self, view: View) -> SteeringInput:
        """See SteeringDevice."""
        plain = self._hand.read(view)
        target = view.targets.next
        if target is None:
            return plain
        left = np.array(target) - np.array(view.state.position)
        self._seen.append((view.now_ns, left))
        velocity = self._steer(self._way_left(view.now_ns), self._step(view))
        instant = Instant(view.now_ns, view.state.position, view.state.velocity, view.free)
        return replace(plain, velocity=self._sidestep.turn(velocity, instant))

    def _way_left(self, now_ns: int) -> Array:
        """To the target, as it was seen `reaction` ago (3,), m; nothing before."""
        seen_ns = now_ns - round(self._own.reaction * 1e9)
        while len(self._seen) > 1 and self._seen[1][0] <= seen_ns:
            self._seen.popleft()
        at_ns, left = self._seen[0]
        return left if at_ns <= seen_ns else np.zeros(3)

    def _step(self, view: View) -> float:
        """Seconds since the last look; learns how late one's own doing shows."""
        dt = 0.0 if self._last_ns is None else (view.now_ns - self._last_ns) * 1e-9
        self._last_ns = view.now_ns
        echo = view.state.echo
        if echo is not None:
            newest = max(0.0, (view.now_ns - echo.t_sent_ns - echo.hold_ns) * 1e-9)
            self._loop += (newest - self._loop) * min(1.0, dt)
        return dt

    def _steer(self, left: Array, dt: float) -> Vector3:
        own = self._own
        delays = own.reaction + own.neuromuscular + self._loop
        gain = min(own.crossover, PHASE / delays)
        wish = gain * left
        size = float(np.linalg.norm(wish))
        if size > own.speed:
            wish *= own.speed / size
        self._asked = self._asked + (1.0 - math.exp(-dt / own.neuromuscular)) * (wish - self._asked)
        kept = math.exp(-dt / CORRELATION)
        self._noise = kept * self._noise + math.sqrt(1.0 - kept * kept) * self._draw.normal(size=3)
        strength = own.noise * float(np.linalg.norm(self._asked))
        return to_vector3((self._asked + strength * self._noise).tolist())
