"""Round trips that are longer than the settings allow: which setting, and what would do."""

import math

ROOM, GRID = 1.25, 0.5
"""The value named is the round trip with this much room, rounded up to a multiple of GRID (s)."""


def beyond_limits(rtt_mean: float, resync_after: float, max_age: float) -> str:
    """One line for people, or empty where the round trip is within both limits.

    Args:
        rtt_mean: measured (s); 0 before anything is known.
        resync_after: `operator.resync_after` (s), infinite where the margin law does not resynchronise.
        max_age: `safety.max_age`, as the robot says (s).
    """
    names = [
        f"{name} = {limit:g} s"
        for name, limit in (("operator.resync_after", resync_after), ("safety.max_age", max_age))
        if rtt_mean >= limit
    ]
    if not names:
        return ""
    enough = math.ceil(rtt_mean * ROOM / GRID) * GRID
    return f"the round trip is longer than {' and '.join(names)}; {enough:g} s would do"
