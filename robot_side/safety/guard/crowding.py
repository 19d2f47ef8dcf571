"""What is so near to a robot that its guard could not keep off it, were it there from now on."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Crowding:
    """A part of the robot, and an obstacle.

    Attributes:
        part, obstacle: their names.
        distance: between the two now (m).
        limit: what is kept (m).
    """

    part: str
    obstacle: str
    distance: float
    limit: float

    def __str__(self) -> str:
        """One line."""
        gap = self.distance
        lies = f"{-1e3 * gap:.0f} mm inside" if gap < 0.0 else f"{1e3 * gap:.0f} mm from"
        if gap < self.limit:
            return f"{self.part} is {lies} obstacle {self.obstacle!r}; {1e3 * self.limit:g} mm are kept"
        who = f"{self.part}, {lies} obstacle {self.obstacle!r},"
        return f"{who} moves too fast to stop before it; ask again once it stands"
