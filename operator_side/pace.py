"""How often the operator's side decides, and how long a step of its plans is: two lengths, one a multiple of the other.

A plan's steps are the controller's, 0.1 s in the paper; a hand feels that. So a tick may be a part of a step: the
same problem, over the same steps, is solved anew at every tick, and a plan is followed for a tick alone while commands
arrive. What lasts is said in seconds and counted here in ticks.
"""

from dataclasses import dataclass

from farhand.operator_side.settings import OperatorScenario

WHOLE = 1e-6
"""By how much a step may miss a whole number of ticks."""


@dataclass(frozen=True, slots=True)
class Pace:
    """Attributes:
    tick: from one command to the next (s).
    step: of a plan (s), a whole number of ticks.
    """

    tick: float
    step: float

    @property
    def ticks_a_step(self) -> int:
        """How many ticks a step of a plan has."""
        return round(self.step / self.tick)

    def ticks(self, seconds: float) -> int:
        """How many ticks last that long, 1 at least."""
        return max(1, round(seconds / self.tick))


def pace_of(scenario: OperatorScenario) -> Pace:
    """Of a scenario: a tick is a step, where no other rate is asked for."""
    step, rate_hz = scenario.controller.period, scenario.operator.rate_hz
    return Pace(step if rate_hz is None else 1.0 / rate_hz, step)


def is_whole(rate_hz: float, step: float) -> bool:
    """Whether a plan's step (s) is a whole number of ticks at that rate, 1 at least."""
    count = rate_hz * step
    return count > 1.0 - WHOLE and abs(count - round(count)) < WHOLE
