"""How the robot really follows its commands, from its echoes and states: lag and acceleration limit, identified online.

The model: dv/dt = (u - v) / lag, no longer than the acceleration limit. From one state to another the robot's own
stamps and echoes tell which commands it followed and for how long, so that each candidate pair predicts the later
velocity from the earlier one; the pair with the smallest squared error over the last motions is the estimate.
Delays, losses and clocks have no part in it. Noting a state is cheap; the estimate is made when it is asked for.
"""

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from farhand.common.geometry import Array
from farhand.common.messages.base import Vector3
from farhand.common.messages.state import RobotState
from farhand.operator_side.prediction.command_history import SentCommand
from farhand.operator_side.prediction.law import Known

LAGS: Array = np.geomspace(0.004, 2.0, 33)
ACCELERATIONS: Array = np.append(np.geomspace(0.2, 20.0, 26), 1e6)
"""The last one stands for none (m/s^2)."""
CALM = 0.002
"""A state that neither changes by more nor is asked to says nothing (m/s)."""
REMEMBERED = 200
"""Motions that are judged, the last ones."""
SPAN, LONGEST = 0.08, 0.25
"""States are compared over this time at least, so that few are; what is longer has holes in it (s)."""
EXCITED = 0.02
"""Sum of squared changes of the velocity that is enough to judge by (m^2/s^2)."""
CLEAR = 2.0
"""By so much the error must grow at half and at twice the estimated lag; else it is not known."""
BINDS = 1.5
"""By so much the error must grow without an acceleration limit; else none has been seen."""


Pieces = list[tuple[Vector3, float]]
"""Commanded velocities (m/s), each with its duration (s)."""
Motion = tuple[Vector3, Vector3, Pieces]
"""From one velocity to another (m/s), by what was commanded meanwhile."""


@dataclass(frozen=True, slots=True)
class Response:
    """Attributes:
    lag: time constant (s); None: not known yet.
    acceleration: the limit (m/s^2); None: none has been seen to bind.
    """

    lag: float | None = None
    acceleration: float | None = None


class Identification:
    """Looks at every state that arrives.

    Args:
        known: the commands sent.
    """

    def __init__(self, known: Known) -> None:
        self._known = known
        self._before: RobotState | None = None
        self._anchor: RobotState | None = None
        self._played: Pieces = []
        self._motions: deque[Motion] = deque(maxlen=REMEMBERED)

    def observe(self, state: RobotState) -> None:
        """Note a state; one that is late, or of which nothing can be learnt, is passed over."""
        before, self._before = self._before, state
        pieces = self._between(before, state) if before is not None else []
        if self._anchor is None or not pieces:
            self._anchor, self._played = state, []
            return
        self._played += pieces
        anchor, elapsed = self._anchor, (state.t_sample_ns - self._anchor.t_sample_ns) * 1e-9
        if elapsed < SPAN:
            return
        pieces, self._played, self._anchor = self._played, [], state
        if elapsed > LONGEST or _is_calm(anchor.velocity, state.velocity, pieces):
            return
        self._motions.append((anchor.velocity, state.velocity, pieces))

    def estimate(self) -> Response:
        """What the states so far say."""
        if sum(math.dist(start, end) ** 2 for start, end, _ in self._motions) < EXCITED:
            return Response()
        errors: Array = np.sum([_squared_errors(*motion) for motion in self._motions], axis=0)
        row, column = np.unravel_index(int(np.argmin(errors)), errors.shape)
        along, floor = np.min(errors, axis=1), max(float(errors[row, column]), 1e-12)
        octave = round(math.log(2.0) / math.log(LAGS[1] / LAGS[0]))
        # At the grid's ends, or where half or twice the lag would do as well, it is not known.
        inside = octave <= row < len(LAGS) - octave
        clear = inside and min(along[row - octave], along[row + octave]) > CLEAR * floor
        lag = _vertex(along, int(row)) if clear else None
        unlimited = float(np.min(errors[:, -1]))
        limited = column < len(ACCELERATIONS) - 1 and unlimited > BINDS * floor
        return Response(lag, float(ACCELERATIONS[column]) if limited else None)

    def _between(self, before: RobotState, state: RobotState) -> Pieces:
        """The commanded velocities between two states, each with its duration; empty where that is not known."""
        if before.session != state.session or not _follows(before) or not _follows(state):
            return []
        known, elapsed = self._known, (state.t_sample_ns - before.t_sample_ns) * 1e-9
        earlier, later = known.applied(before), known.applied(state)
        if earlier is None or later is None or elapsed <= 0.0:
            return []
        held_before, held = before.applied_for_ns * 1e-9, state.applied_for_ns * 1e-9
        if earlier.seq == later.seq:
            return _played(later, held - elapsed, held)
        rest = elapsed - held
        # What was applied in between for less than a state's time is not known.
        if later.seq < earlier.seq or rest < 0.0 or (later.seq - earlier.seq > 1 and rest > known.period):
            return []
        return _played(earlier, held_before, held_before + rest) + _played(later, 0.0, held)


def _follows(state: RobotState) -> bool:
    """Whether it does what it was told: no guard and no limit had a hand in it."""
    return state.mode == "run" and not state.guard and not state.held_by


def _played(command: SentCommand, begin: float, end: float) -> Pieces:
    """The velocities of a command's plan from `begin` to `end` s after it took effect."""
    pieces: Pieces = []
    entry = int(max(0.0, begin) / command.period)
    at = max(0.0, begin)
    while at < end - 1e-9:
        until = min(end, (entry + 1) * command.period)
        if until > at:
            pieces.append((command.velocity(entry), until - at))
        at, entry = until, entry + 1
    return pieces


def _is_calm(start: Vector3, end: Vector3, pieces: Pieces) -> bool:
    return max(math.dist(start, end), *(math.dist(start, wanted) for wanted, _ in pieces)) < CALM


def _squared_errors(start: Vector3, end: Vector3, pieces: Pieces) -> Array:
    """(lags, accelerations) squared distance between the predicted and the reported velocity (m^2/s^2)."""
    velocity: Array = np.array(start).reshape(1, 1, 3)  # the same for all candidates, up to the first piece
    for wanted, duration in pieces:
        away = velocity - np.array(wanted)
        gap = np.sqrt(np.einsum("abk,abk->ab", away, away))
        # At the limit straight towards what is wanted, until the lag asks for less.
        straight = np.minimum(np.maximum(gap - _SOFT, 0.0) / ACCELERATIONS, duration)
        left = (gap - straight * ACCELERATIONS) * np.exp((straight - duration) / LAGS[:, None])
        velocity = wanted + away * (left / np.maximum(gap, 1e-12))[:, :, None]
    error = velocity - np.array(end)
    found: Array = np.einsum("abk,abk->ab", error, error)
    return found


_SOFT: Array = LAGS[:, None] * ACCELERATIONS
"""(lags, accelerations) gap below which the lag asks for less than the limit (m/s)."""


def _vertex(errors: Array, at: int) -> float:
    """The lag at the lowest point of the parabola through three errors, over the logarithm of the lag (s)."""
    if not 0 < at < len(LAGS) - 1:
        return float(LAGS[at])
    low, middle, high = errors[at - 1 : at + 2]
    bend = low - 2.0 * middle + high
    shift = 0.5 * (low - high) / bend if bend > 0.0 else 0.0
    return float(LAGS[at] * (LAGS[1] / LAGS[0]) ** shift)
