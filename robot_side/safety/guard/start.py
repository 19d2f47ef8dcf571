"""Refuses a start from which the guard could not keep what it promises."""

from typing import Protocol

from farhand.common.errors import ScenarioError
from farhand.common.messages.scene import Obstacle
from farhand.common.quantities import Vector3
from farhand.common.shapes.distance import nearest_obstacle
from farhand.robot_side.safety.guard.settings import GuardSettings


class Start(Protocol):
    """What is read of a scenario."""

    @property
    def name(self) -> str:
        """For messages."""
        ...

    @property
    def start(self) -> Vector3:
        """Tool position (m)."""
        ...

    @property
    def obstacles(self) -> tuple[Obstacle, ...]:
        """As they are at the start."""
        ...

    @property
    def guard(self) -> GuardSettings:
        """What is kept."""
        ...


def check_tool_clear(scenario: Start, radius: float) -> None:
    """Raise ScenarioError where the sphere around the tool starts in an obstacle, or nearer than the guard keeps."""
    gap, name = nearest_obstacle(scenario.obstacles, scenario.start)
    if gap - radius < scenario.guard.d_min:
        raise refusal(scenario, "the tool", gap - radius, f"obstacle {name!r}")


def refusal(scenario: Start, part: str, gap: float, what: str) -> ScenarioError:
    """The one line.

    Args:
        scenario: whose start it is.
        part, what: what is how near to what, in words.
        gap: between the two (m).
    """
    lies = f"{-1e3 * gap:.0f} mm inside" if gap < 0.0 else f"{1e3 * gap:.0f} mm from"
    return ScenarioError(
        f"scenario {scenario.name}: start: {part} stands {lies} {what}; the guard keeps "
        f"{1e3 * scenario.guard.d_min:g} mm: move one of them, or change robot.joints or guard.d_min"
    )
