"""Capsules around all links of an arm, what they cost, and which pairs of them say nothing of a collision."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from farhand.common.errors import InputError
from farhand.common.geometry import Array
from farhand.robot_side.arm.capsules import CapsuleFile, FittedCapsule, capsule_text
from farhand.robot_side.arm.description.urdf import Chain
from farhand.robot_side.arm.fitting.body import Body, bodies
from farhand.robot_side.arm.fitting.excess import excess
from farhand.robot_side.arm.fitting.fit import Capsule, fit
from farhand.robot_side.arm.model import ArmModel, assemble

MOSTLY = 0.95
"""Of all configurations: a pair whose capsules overlap so often says nothing of a collision."""
CONFIGURATIONS = 400
BAD = 0.045
"""Excess (m) from which two capsules are tried."""
BETTER = 0.75
"""Of the excess of one, which two must stay under to be worth it."""
CUTS = (0.3, 0.5, 0.7)


@dataclass(frozen=True, slots=True)
class FittedLink:
    """What was found for one capsule.

    Attributes:
        link: name.
        capsule: in the link's frame.
        vertices: of the link's collision geometry.
        outside: how far the vertex that sticks out most does (m); not above 0.
        excess_median, excess_max: distance of the capsule's surface from the geometry's hull (m).
        covered_by: the link of the same rigid body whose capsule holds this link as well; empty: it needs its own.
    """

    link: str
    capsule: Capsule
    vertices: int
    outside: float
    excess_median: float
    excess_max: float
    covered_by: str = ""


@dataclass(frozen=True, slots=True)
class Overlap:
    """Two links whose capsules overlap where the links need not touch.

    Attributes:
        links: their names.
        at_home: gap of the capsules at home (m); negative: they overlap.
        share: of random configurations in which they overlap.
    """

    links: tuple[str, str]
    at_home: float
    share: float


@dataclass(frozen=True, slots=True)
class FittedArm:
    """All of an arm's links, and the pairs that are not kept apart."""

    links: tuple[FittedLink, ...]
    overlaps: tuple[Overlap, ...]

    @property
    def outside(self) -> float:
        """How far the vertex that sticks out most does (m); not above 0."""
        return max(each.outside for each in self.links)

    def text(self, source: str) -> str:
        """What is kept, as TOML; `source` are the options that the arm was chosen with."""
        return capsule_text(
            self.file, [f"Fitted by `farhand arm fit {source}`. Lengths in m, in the links' own frames."]
        )

    @property
    def file(self) -> CapsuleFile:
        """What is kept."""
        return _file(self.links, [overlap.links for overlap in self.overlaps])


def fit_arm(
    chain: Chain,
    tool_frame: str,
    never_colliding: frozenset[frozenset[str]],
    home: Array,
    rng: np.random.Generator,
) -> FittedArm:
    """Fit a capsule to every link that has collision geometry.

    Args:
        chain: from the URDF.
        tool_frame: link.
        never_colliding: pairs of links whose contact means nothing.
        home: (n,) rad.
        rng: draws the configurations in which overlaps are counted.

    Raises InputError when a mesh cannot be read, or no link has any geometry.
    """
    found = bodies(chain.text)
    if not found:
        raise InputError(f"URDF of {chain.name!r}: no link has collision geometry")
    standing = chain.standing
    pieces = [piece for link, body in found.items() for piece in _fitted(link, body, link not in standing)]
    links = _mark_covered(pieces, assemble(chain, tool_frame, never_colliding, _file(pieces, [])))
    arm = assemble(chain, tool_frame, never_colliding, _file(links, []))
    return FittedArm(links, tuple(_overlaps(arm, home, rng)))


def _fitted(link: str, body: Body, moves: bool) -> list[FittedLink]:
    """One capsule; two for a link that moves, where one is bad and two are better."""
    one = _measured(link, [body], body)
    if one[0].excess_max <= BAD or not moves:
        return one
    halves = (_measured(link, halved, body) for halved in _halves(body, one[0].capsule))
    two = min(halves, key=_worst, default=one)
    return two if _worst(two) < BETTER * _worst(one) else one


def _measured(link: str, pieces: Sequence[Body], whole: Body) -> list[FittedLink]:
    capsules = [fit(piece) for piece in pieces]
    outside = max(capsule.outside(piece) for capsule, piece in zip(capsules, pieces, strict=True))
    found = []
    for index, capsule in enumerate(capsules):
        others = capsules[:index] + capsules[index + 1 :]
        more = excess(capsule, others, whole.hull())
        found.append(
            FittedLink(link, capsule, len(whole.points), outside, float(np.median(more)), float(np.max(more)))
        )
    return found


def _worst(pieces: Sequence[FittedLink]) -> float:
    return max(piece.excess_max for piece in pieces)


def _halves(body: Body, capsule: Capsule) -> Iterator[tuple[Body, Body]]:
    """The body cut in two, at some heights across its capsule and across the directions in which it is long."""
    body = body.hull()
    if body.radii.any():
        return  # balls are not cut
    along = capsule.b - capsule.a
    if np.linalg.norm(along) > capsule.radius / 2.0:
        directions = [along / np.linalg.norm(along)]
    else:
        directions = list(np.linalg.svd(body.points - body.points.mean(axis=0), full_matrices=False)[2][:2])
    for direction in directions:
        heights = body.points @ direction
        low, high = float(heights.min()), float(heights.max())
        for share in CUTS:
            yield cut(body.points, direction, low + share * (high - low))


def cut(points: Array, direction: Array, height: float) -> tuple[Body, Body]:
    """Two bodies whose hulls together are the hull of the points (m, 3), below and above a plane across a direction."""
    above = points @ direction - height
    lower, upper = points[above <= 0.0], points[above >= 0.0]
    down, up = above[above <= 0.0][:, None], above[above >= 0.0][None, :]
    share = np.where(up > down, -down / np.maximum(up - down, 1e-12), 0.0)
    crossing = lower[:, None] + share[..., None] * (upper[None] - lower[:, None])
    crossing = crossing.reshape(-1, 3)
    below, beyond = (np.concatenate([half, crossing]) for half in (lower, upper))
    return Body(below, np.zeros(len(below))).hull(), Body(beyond, np.zeros(len(beyond))).hull()


def _mark_covered(links: Sequence[FittedLink], arm: ArmModel) -> tuple[FittedLink, ...]:
    """The same; links that lie in another's capsule, which moves with the same joint, say so."""
    marked = list(links)
    for i, one in enumerate(arm.capsules):
        for j, other in enumerate(arm.capsules):
            within = Capsule(other.a, other.b, other.radius).distances(np.array([one.a, one.b])) + one.radius
            if i != j and one.joint == other.joint and float(within.max()) <= other.radius:
                marked[i] = replace(marked[i], covered_by=other.part)
    return tuple(marked)


def _overlaps(arm: ArmModel, home: Array, rng: np.random.Generator) -> Iterator[Overlap]:
    """Pairs of links whose capsules overlap at home, or nearly always."""
    at_home = arm.self_gaps(home)
    configurations = rng.uniform(arm.lower, arm.upper, (CONFIGURATIONS, arm.n))
    overlapping = np.mean([arm.self_gaps(q) < 0.0 for q in configurations], axis=0)
    told = set()
    for (i, j), gap, share in zip(arm.self_pairs, at_home, overlapping, strict=True):
        links = arm.capsules[i].part, arm.capsules[j].part
        if (gap < 0.0 or share > MOSTLY) and links not in told:
            told.add(links)
            yield Overlap(links, float(gap), float(share))


def _file(links: Sequence[FittedLink], overlapping: Sequence[tuple[str, str]]) -> CapsuleFile:
    capsules = [
        FittedCapsule(
            link=each.link,
            a=tuple(each.capsule.a.tolist()),
            b=tuple(each.capsule.b.tolist()),
            radius=each.capsule.radius,
        )
        for each in links
        if not each.covered_by
    ]
    return CapsuleFile(capsules=tuple(capsules), overlapping=tuple(overlapping))
