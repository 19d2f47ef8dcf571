"""The margin of each tick, taken apart so that its parts add up, and how often it held."""

import numpy as np

from farhand.common.geometry import Array
from farhand.report.reading.story import Story

LAG = "lag"
"""What comes on top of every law's own."""


def width_of(story: Story) -> Array:
    """(n,) the whole margin of each tick: of the radii, and of the barrier (m)."""
    return story.ticks["inflation"] + story.ticks["sigma"]


def additive(story: Story) -> tuple[dict[str, Array], bool]:
    """(n,) each part as what it adds to the margin (m), and whether the law is the largest of its parts.

    A law that takes the largest of its parts has that one in full, and nothing of the others.
    """
    parts, total = story.parts.arrays(), width_of(story)
    if not parts:
        return ({"margin": total} if len(total) and total.any() else {}), False
    names = list(parts)
    values = np.array([parts[name] for name in names]).reshape(len(names), -1)
    if np.allclose(values.sum(axis=0), total, atol=1e-6):
        return parts, False
    own = [k for k, name in enumerate(names) if name != LAG]
    lag = parts.get(LAG, np.zeros(len(total)))
    found = {name: np.zeros(len(total)) for name in names}
    if own:
        largest = np.array(own)[values[own].argmax(axis=0)]
        for k in own:
            found[names[k]] = np.where(largest == k, total - lag, 0.0)
    found[LAG] = lag
    return {name: value for name, value in found.items() if value.any()}, True


def coverage(story: Story) -> tuple[int, float] | None:
    """How often the margin held: ticks that are judged, and the share in which it did; None: none can be.

    The newest error of the prediction in a tick is held against the margin of the tick before: that of its own tick may
    have grown by this very error, and then says nothing.
    """
    ticks = story.ticks
    judged = (np.diff(ticks["number"]) == 1) & (ticks["seen"][:-1] > 0) & (ticks["seen"][1:] > 0)
    if not judged.any():
        return None
    held = ticks["error"][1:] <= width_of(story)[:-1]
    return int(judged.sum()), float(held[judged].mean())
