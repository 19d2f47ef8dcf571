"""A shape with a name and a place in the base frame, and how it moves."""

from collections.abc import Callable
from typing import Annotated, Any, TypeAlias

import msgspec
from msgspec import Meta, Struct

from farhand.common.quantities import ZERO, Name, NonNegative, Positive, Quaternion, Vector3
from farhand.common.shapes.motion import Shuttle, shuttle
from farhand.common.shapes.pose import UPRIGHT
from farhand.common.shapes.shape import Shape
from farhand.common.shapes.sphere import Sphere

MAX_WAY_POINTS = 64
Way: TypeAlias = Callable[[float], tuple[Vector3, Vector3]]
_LEFT_OUT: Any = msgspec.UNSET
_NORM_TOLERANCE = 1e-3
_PLACE_TOLERANCE = 1e-3  # m and m/s


class Obstacle(Struct, frozen=True, omit_defaults=True, forbid_unknown_fields=True):
    """What is to be kept clear of: it stands, moves at constant velocity, or shuttles along a path.

    A shuttle goes from way-point to way-point of `path` and back the same way, for ever; it stops at each of
    them. Its position and velocity follow from its path and `phase`, and may be left out.

    Attributes:
        id: its name.
        position: of the origin of the shape's frame (m).
        radius: the short form of a sphere: `radius = 0.07` instead of a shape. Never there afterwards.
        velocity: (m/s).
        shape: in its own frame.
        orientation: of the shape's frame, unit quaternion (w, x, y, z).
        acceleration: bound on its acceleration (m/s^2); a shuttle starts and brakes with it.
        path: way-points of a shuttle (m); empty: it is none.
        speed: of a shuttle between its way-points (m/s).
        phase: for how long a shuttle has been on its way since it left the first way-point (s).

    Raises:
        ValueError: it has neither or both of radius and shape, or what is said of its motion is no motion.
    """

    id: Name
    position: Vector3 = _LEFT_OUT
    radius: Positive | msgspec.UnsetType = msgspec.UNSET
    velocity: Vector3 = ZERO
    shape: Shape = _LEFT_OUT
    orientation: Quaternion = UPRIGHT
    acceleration: NonNegative = 0.0
    path: Annotated[tuple[Vector3, ...], Meta(max_length=MAX_WAY_POINTS)] = ()
    speed: NonNegative = 0.0
    phase: NonNegative = 0.0

    def __post_init__(self) -> None:
        self._settle_defaults()
        self._settle_shape()
        if not abs(sum(q * q for q in self.orientation) - 1.0) < 2 * _NORM_TOLERANCE:
            raise ValueError("orientation: must be a unit quaternion (w, x, y, z)")
        if self.path:
            self._settle_on_path()
        elif self.speed or self.phase:
            raise ValueError("speed and phase are those of a shuttle, which needs a path")
        elif self.position is _LEFT_OUT:
            raise ValueError("object missing required field `position`")

    @property
    def moves(self) -> bool:
        """Whether it ever leaves its place."""
        return bool(self.path) or any(self.velocity)

    def _settle_defaults(self) -> None:
        """What equals its default becomes it: only the very object is left out of the bytes, which must be the same
        of an obstacle that was written, copied or came from another process."""
        for name, default in _DEFAULTS:
            if getattr(self, name) == default:
                msgspec.structs.force_setattr(self, name, default)

    def _settle_shape(self) -> None:
        if self.radius is not msgspec.UNSET:
            if self.shape is not _LEFT_OUT:
                raise ValueError("radius: is the short form of a sphere, and there is a shape already")
            msgspec.structs.force_setattr(self, "shape", Sphere(self.radius))
            msgspec.structs.force_setattr(self, "radius", msgspec.UNSET)
        elif self.shape is _LEFT_OUT:
            raise ValueError("object missing required field `shape`, or the `radius` of a sphere")

    def _settle_on_path(self) -> None:
        position, velocity = self.shuttle.at(self.phase)
        given = (("position", self.position, position), ("velocity", self.velocity, velocity))
        for name, said, is_ in given:
            told = said is not _LEFT_OUT and (name == "position" or any(said))
            if told and not max(abs(s - i) for s, i in zip(said, is_, strict=True)) <= _PLACE_TOLERANCE:
                raise ValueError(f"{name}: follows from the path of a shuttle; leave it out")
            msgspec.structs.force_setattr(self, name, is_)

    @property
    def shuttle(self) -> Shuttle:
        """Its motion along its path; raises ValueError where that is none."""
        return shuttle(self.path, self.speed, self.acceleration)


_DEFAULTS = tuple(
    (field.name, field.default)
    for field in msgspec.structs.fields(Obstacle)
    if field.default is not msgspec.NODEFAULT and field.default is not msgspec.UNSET
)


FARTHEST = 1e6
"""m: no message says more of a place."""


def moved(obstacle: Obstacle, seconds: float) -> Obstacle:
    """The same obstacle `seconds` later (s); the same object where it stands."""
    if not obstacle.moves:
        return obstacle
    if obstacle.path:
        motion = obstacle.shuttle
        phase = (obstacle.phase + seconds) % motion.period
        position, velocity = motion.at(phase)
        return msgspec.structs.replace(obstacle, phase=phase, position=position, velocity=velocity)
    return msgspec.structs.replace(obstacle, position=place(obstacle, seconds)[0])


def place(obstacle: Obstacle, seconds: float) -> tuple[Vector3, Vector3]:
    """Position and velocity of an obstacle `seconds` later (m, m/s)."""
    return way_of(obstacle)(seconds)


def _within(metres: float) -> float:
    return min(max(metres, -FARTHEST), FARTHEST)


def way_of(obstacle: Obstacle) -> Way:
    """What `place` says of one obstacle, for those who ask often."""
    if obstacle.path:
        motion, phase = obstacle.shuttle, obstacle.phase
        return lambda seconds: motion.at(phase + seconds)
    (x, y, z), (u, v, w) = obstacle.position, obstacle.velocity
    velocity = obstacle.velocity

    def straight(seconds: float) -> tuple[Vector3, Vector3]:
        at = (x + seconds * u, y + seconds * v, z + seconds * w)
        if max(map(abs, at)) > FARTHEST:  # no message holds more; nothing is near there
            at = (_within(at[0]), _within(at[1]), _within(at[2]))
        return at, velocity

    return straight
