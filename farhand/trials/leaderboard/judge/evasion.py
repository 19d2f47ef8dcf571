"""Whether a robot that came too near to something could have evaded, by the truth about a run and what follows from it.

A violation of a sphere could have been evaded if there is an instant, in the WINDOW before it began, in which the robot
was free to move, and a constant velocity from there on, kept or ended after one of HALTS, under which it stays clear of
everything, the movers on their true ways, until TAIL after the violation began. Velocities: zero, and 26 directions at
shares of what the robot takes; it follows them with its lag. A latched stop after that instant holds in the way as it
did in the run.

It was *run over* if it could not, and stood in a latched stop when the violation began: then it may not move, whatever
comes. The seconds of a stop in which its guard may still step aside are none of that.

What is not judged, arms and scenes in which nothing moves, counts as evadable: there it is enough to stop in time.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from farhand.common.geometry import Array, Vector3, norm, to_vector3
from farhand.common.shapes.distance import distance_to
from farhand.common.shapes.obstacle import Obstacle, moved, way_of
from farhand.common.shapes.sphere import Sphere
from farhand.runs.scenario import Scenario

WINDOW, TAIL = 2.0, 1.0
"""s: how long before a violation evasion may begin; how long after its beginning the way must be clear."""
EVERY, STEP = 0.1, 0.01
"""s: between two instants in which evasion may begin; between two places of a way."""
HALTS = (math.inf, 1.0, 0.5, 0.25)
"""s: after which a velocity ends."""
SHARES = (0.125, 0.25, 0.5, 1.0)
"""Of the greatest speed that the robot takes."""
AT_REST = 0.01
"""m/s."""
_DIRECTIONS = np.array([d for d in product((-1.0, 0.0, 1.0), repeat=3) if any(d)])
_DIRECTIONS /= np.linalg.norm(_DIRECTIONS, axis=1, keepdims=True)


Ways = NDArray[np.bool_]
"""Which of some ways."""


@dataclass(frozen=True, slots=True)
class Moment:
    """Attributes:
    t: since the start (s).
    position, velocity: of the tool (m, m/s).
    stopped: in a latched stop in which its guard, too, may not move it.
    """

    t: float
    position: Vector3
    velocity: Vector3
    stopped: bool


@dataclass(frozen=True, slots=True)
class Encounter:
    """A violation and what was before.

    Attributes:
        before: moments up to and with its beginning, the last of all.
        already: what the robot was too near to when it began: another violation, and judged as such. It is enough to
            get no nearer to it.
    """

    before: tuple[Moment, ...]
    already: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class Verdict:
    """Attributes:
    evadable: violations that the robot could have evaded.
    run_over: of the others, those in which it stood in a latched stop.
    """

    evadable: int
    run_over: int


def judged(count: int, encounters: Sequence[Encounter], scenario: Scenario) -> Verdict:
    """All violations of a run.

    Args:
        count: of the violations.
        encounters: those that can be judged; none of an arm, nor where nothing moves.
        scenario: with what is around.
    """
    others = [each for each in encounters if not _could_evade(each, scenario)]
    return Verdict(count - len(others), sum(map(_stood, others)))


def _stood(encounter: Encounter) -> bool:
    last = encounter.before[-1]
    return last.stopped and norm(last.velocity) < AT_REST


def _could_evade(encounter: Encounter, scenario: Scenario) -> bool:
    before, began = encounter.before, encounter.before[-1].t
    moves = [moment.t for moment in before if not moment.stopped]
    # of the latched stop in which the violation began, if it did
    stopped_at = math.inf if not before[-1].stopped else max(moves, default=-math.inf)
    due, starts = began - WINDOW - 0.5 * STEP, []
    for moment in before[:-1]:
        if moment.t >= due and not moment.stopped:
            starts.append(moment)
            due = moment.t + EVERY - 0.5 * STEP
    already = encounter.already
    return any(_way_from(moment, began + TAIL, stopped_at, scenario, already) for moment in starts)


def _way_from(
    moment: Moment, until: float, stopped_at: float, scenario: Scenario, already: frozenset[str]
) -> bool:
    """Whether some way from a moment on meets nothing until then (s)."""
    fastest = scenario.safety.max_speed
    wishes = np.vstack([np.zeros((1, 3)), *(share * fastest * _DIRECTIONS for share in SHARES)])
    count = math.ceil((until - moment.t) / STEP) + 1
    times = np.linspace(moment.t, moment.t + STEP * (count - 1), count)
    stops = {min(stopped_at, moment.t + halt) for halt in HALTS}
    places = np.vstack([_ways(moment, wishes, times, stop, scenario.robot.lag) for stop in sorted(stops)])
    free = np.ones(len(places), bool)
    for obstacle in scenario.obstacles:
        kept = scenario.robot.radius + scenario.controller.d_min
        if obstacle.id in already:
            kept = min(kept, distance_to(moved(obstacle, moment.t), moment.position) - 1e-6)
        free = _clear(places, times, obstacle, kept, free)
        if not free.any():
            return False
    return True


def _ways(moment: Moment, wishes: Array, times: Array, stopped_at: float, lag: float) -> Array:
    """(wishes, times, 3): where the robot is under each of the wishes (n, 3), which a stop makes zero (m)."""
    x, v = np.array(moment.position), np.array(moment.velocity)
    t = times - moment.t
    before = np.minimum(t, max(0.0, stopped_at - moment.t))
    after = t - before

    def response(seconds: Array) -> Array:
        """Of a velocity, the way that is left of it after so long (s)."""
        return np.asarray(-lag * np.expm1(-seconds / lag) if lag > 0.0 else 0.0 * seconds)

    gap = v - wishes
    found = x + wishes[:, None] * before[:, None] + gap[:, None] * response(before)[:, None]
    decay = np.exp(-before / lag) if lag > 0.0 else np.zeros_like(before)
    then = wishes[:, None] + gap[:, None] * decay[:, None]
    result: Array = found + then * response(after)[:, None]
    return result


def _clear(places: Array, times: Array, obstacle: Obstacle, kept: float, asked: Ways) -> Ways:
    """(ways,): which of the ways that are asked for keep so far (m) of an obstacle on its way."""
    way = way_of(obstacle)
    centres = np.array([way(float(t))[0] for t in times])
    near = np.linalg.norm(places - centres, axis=2) - obstacle.shape.bounding_radius < kept
    found: Ways = asked & ~near.any(axis=1)
    if isinstance(obstacle.shape, Sphere):
        return found
    for index in np.flatnonzero(asked & ~found):
        found[index] = all(
            distance_to(moved(obstacle, float(times[k])), to_vector3(places[index, k])) >= kept
            for k in np.flatnonzero(near[index])
        )
    return found
