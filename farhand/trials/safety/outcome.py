"""One adversarial run: what is asked for, and what came of it. Both travel between processes and into files."""

import msgspec


class Case(msgspec.Struct, frozen=True, kw_only=True):
    """One run of a robot under hostile commands.

    Attributes:
        robot: `ur5`, `panda`, `box`, `point`.
        index: of the run; decides mode, errors, and everything else that is drawn.
        scene: of the scene that it is in.
        speed: of the obstacles that move (m/s); 0: all stand.
        mode: of the commands.
        lag_error, acceleration_error: true value over the one that the guard was told, less 1.
        acceleration: bound of a point's acceleration as told (m/s^2); 0: none. Of arms, in rad/s^2 from the model.
        guarded: whether the guard is on.
        duration: (s).
        physics: in PyBullet, where the robot has a body there that is not the rule.
    """

    robot: str
    index: int
    scene: int
    speed: float
    mode: str
    lag_error: float
    acceleration_error: float
    acceleration: float = 0.0
    guarded: bool = True
    duration: float = 20.0
    physics: bool = False

    @property
    def key(self) -> str:
        """Names the run within a trial."""
        words = [self.robot, f"{self.speed:g}", str(self.index)]
        return "/".join(words + ["physics"] * self.physics + ["free"] * (not self.guarded))


class Outcome(msgspec.Struct, frozen=True, kw_only=True):
    """Attributes:
    case: what was asked for.
    nearest: least true distance to an obstacle (m); 1e6 without any near.
    nearest_self: least true distance of two links (m); None without links.
    two: these links.
    part, obstacle: of the least distance.
    at: when that was (s).
    reason: why it came too near, where it did.
    slowed: share of the ticks in which the guard did something.
    pinched: ticks in which nothing kept all rows.
    travelled: way of the tool (m): a guard that only stands proves nothing.
    error: what crashed.
    """

    case: Case
    nearest: float = 1e6
    nearest_self: float | None = None
    two: str = ""
    part: str = ""
    obstacle: str = ""
    at: float = 0.0
    reason: str = ""
    slowed: float = 0.0
    pinched: int = 0
    travelled: float = 0.0
    error: str = ""

    def violates(self, d_min: float) -> bool:
        """Whether something came nearer than it may, or the run crashed."""
        near = min(self.nearest, self.nearest_self if self.nearest_self is not None else self.nearest)
        return bool(self.error) or near < d_min
