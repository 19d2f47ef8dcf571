"""What the guard on the robot did to a command."""

from typing import Literal

from msgspec import Struct

from farhand.common.messages.base import Name, NameOrNone, Real

Deed = Literal["slowed", "turned", "evading", "braking"]


class Intervention(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The guard did something else than what was asked, for the sake of one part and one obstacle.

    Attributes:
        part: of the robot: a link's name, or `tool`.
        obstacle: its id; for a link that must stay off another link, that one's name; empty: not told.
        distance: between the two now (m).
        limit: that nothing may come nearer than, `guard.d_min` (m); the guard keeps 2 to 3 mm more.
        asked, done: speed of the tool that was asked for, and that it lets through (m/s).
        what: `slowed`: less speed; `turned`: another direction, by much or with hardly less speed; `evading`: away from
            what moves, faster than asked or unasked; `braking`: nothing that was asked could be done in time to stop.
    """

    part: Name
    obstacle: NameOrNone
    distance: Real
    limit: Real
    asked: Real
    done: Real
    what: Deed


TURNED = 0.9
"""Cosine between asked and done under which the direction is another, whatever the speed."""
SLOW = 1e-3
"""m/s: a difference under this is none that anybody sees."""


def deed(asked: tuple[float, float, float], done: tuple[float, float, float], *, moves: bool) -> Deed | None:
    """What was done to a linear velocity (m/s); None where it goes through unseen.

    Args:
        asked, done: (m/s).
        moves: whether the obstacle does.
    """
    ax, ay, az = asked
    dx, dy, dz = done
    change = ((ax - dx) ** 2 + (ay - dy) ** 2 + (az - dz) ** 2) ** 0.5
    if change < SLOW:
        return None
    before = (ax * ax + ay * ay + az * az) ** 0.5
    after = (dx * dx + dy * dy + dz * dz) ** 0.5
    if moves and after > before + SLOW:
        return "evading"
    if after < SLOW:
        return "slowed"
    along = (ax * dx + ay * dy + az * dz) / (before * after) if before > 0.0 else 0.0
    if along >= TURNED and before - after >= SLOW:
        return "slowed"
    return "evading" if moves and along < 0.0 else "turned"
