"""How much of what is asked is not done: what a hand is to feel."""

import math

from farhand.common.geometry import norm
from farhand.common.messages.base import Vector3
from farhand.common.messages.report import ControlReport

STILL = 1e-3
"""m/s and rad/s: less than this is not asked."""
FELT = 0.05
"""Less than this share is nothing."""


def resistance(report: ControlReport) -> float:
    """The share of what is asked that is not done, 0..1, of moving or of turning, whichever is larger.

    Done is what the operator's side sends, and no more than the robot's guard lets through.
    """
    done = report.filtered, report.angular
    shares = [_share(report.desired, done[0]), _share(report.desired_angular, done[1])]
    guard = report.guard
    if guard is not None and guard.asked > STILL:
        shares.append(1.0 - guard.done / guard.asked)
    most = min(1.0, max(shares))
    return most if most > FELT else 0.0


def _share(asked: Vector3, done: Vector3) -> float:
    size = norm(asked)
    return math.dist(asked, done) / size if size > STILL else 0.0
