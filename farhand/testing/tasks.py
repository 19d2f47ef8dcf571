"""A task that takes two seconds, for tests with real programs."""

from collections.abc import Sequence
from pathlib import Path

from farhand.common.messages.base import Vector3

SHORT_TASK = """
name = "short"
start = [0.0, 0.0, 0.5]
targets = {targets}
{more}
[robot]
kind = "point"
radius = 0.05
rate_hz = 100
state_rate_hz = 50
lag = 0.1
"""


def short_task(folder: Path, targets: Sequence[Vector3] = ((0.7, 0.0, 0.5),), more: str = "") -> Path:
    """Write a scenario with a point of 0.05 m at (0, 0, 0.5) m and no obstacle.

    Args:
        folder: where `short.toml` is written.
        targets: where to go, in order (m).
        more: TOML put in before the robot's section, such as `[[obstacles]]`.
    """
    path = folder / "short.toml"
    path.write_text(SHORT_TASK.format(targets=[list(t) for t in targets], more=more), encoding="utf-8")
    return path
