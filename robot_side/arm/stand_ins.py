"""Stand-ins: what keeps two links apart whose own capsules overlap although the links do not touch.

Some links stay within a few centimetres of each other by how the arm is built, and yet meet when a joint folds one onto
the other. Their capsules are too thick to tell these cases apart. A slimmer body takes the place of one of them, or of
both: not one that holds the link, but one for which this is true at all joint positions:

    where the stand-ins are 10 mm apart or more, so are the links.

Each radius is the least for which that holds on a fine grid of the joints between the two links, with 2.5 mm to spare.
Between its points a search found 10.7 mm at the least; tests look at random positions. The SRDFs of
these arms call such pairs harmless; by their meshes they are not.
Pairs that nothing brings nearer than 10 mm have none: base and upper arm of the UR10, the URs' wrists 1 and 3.
"""

from dataclasses import dataclass

from farhand.common.geometry import Vector3


@dataclass(frozen=True, slots=True)
class Part:
    """A capsule, or a sphere, in the frame of the joint that moves its link; in base where none does (m)."""

    link: str
    a: Vector3
    b: Vector3
    radius: float


@dataclass(frozen=True, slots=True)
class StandIn:
    """Attributes:
    part: what takes the place of one link.
    against: what it is kept from: a body in the place of the other link, or the capsules of the link of that name.
    """

    part: Part
    against: Part | str


def _ball(link: str, z: float, radius: float) -> Part:
    return Part(link, (0.0, 0.0, z), (0.0, 0.0, z), radius)


def _tube(link: str, y: float, start: float, end: float, radius: float) -> Part:
    return Part(link, (0.0, y, start), (0.0, y, end), radius)


def _wrist(y: float, start: float, end: float, radii: tuple[float, float]) -> tuple[StandIn, ...]:
    """The tube of a UR's forearm, without the end that holds the wrist, against the wrist's last two links."""
    return tuple(
        StandIn(_tube("forearm_link", y, start, end, radius), wrist)
        for wrist, radius in zip(("wrist_2_link", "wrist_3_link"), radii, strict=True)
    )


def _crook(radius: float) -> Part:
    return Part("panda_link5", (0.0, 0.038, -0.119), (0.0, 0.0, -0.215), radius)


STAND_INS: dict[str, tuple[StandIn, ...]] = {
    "ur3": (
        StandIn(_ball("base_link", -0.3, 0.219), _ball("upper_arm_link", 0.24365, 0.07)),
        *_wrist(-0.015, 0.064, 0.143, (0.044, 0.047)),
    ),
    "ur5": (
        StandIn(_ball("base_link", -0.3, 0.4), _ball("upper_arm_link", 0.425, 0.08)),
        *_wrist(0.0, 0.118, 0.322, (0.041, 0.044)),
    ),
    "ur10": _wrist(0.0, 0.172, 0.492, (0.044, 0.046)),
    "panda": (StandIn(_crook(0.086), "panda_link7"), StandIn(_crook(0.063), "panda_hand")),
}
"""Of base and upper arm: where the second joint would lower the upper arm onto the base, the elbow, a ball, would come
into another one below the base."""
