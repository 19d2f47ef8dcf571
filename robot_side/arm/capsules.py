"""Capsules around an arm's links, as data: what `farhand arm fit` writes and every start reads.

A file says of each capsule the link, its ends in the link's frame and its radius, and which pairs of links are
not kept apart because their capsules overlap though the links do not touch.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import msgspec
import numpy as np
from msgspec import Meta

from farhand.common.errors import InputError
from farhand.common.geometry import Array
from farhand.common.quantities import Name, Positive, Vector3
from farhand.common.scenario.reader import name_key, non_finite_key
from farhand.common.scenario.section import Section
from farhand.common.toml import read_toml

MAX_CAPSULES = 32


@dataclass(frozen=True, slots=True, eq=False)
class LinkCapsule:
    """All points within `radius` (m) of the segment from `a` to `b`, which moves with one joint.

    Attributes:
        part: name of the link; `tool` for what the user put on the arm.
        joint: index of the joint that moves it; -1: the base.
        a, b: (3,) ends of the segment in that joint's frame (m).
        radius: in m.
    """

    part: str
    joint: int
    a: Array
    b: Array
    radius: float


class FittedCapsule(Section, frozen=True, kw_only=True):
    """One capsule in its link's frame (m)."""

    link: Name
    a: Vector3
    b: Vector3
    radius: Positive


class CapsuleFile(Section, frozen=True, kw_only=True):
    """Attributes:
    capsules: at least one.
    overlapping: pairs of links that are not kept apart.
    """

    capsules: Annotated[tuple[FittedCapsule, ...], Meta(min_length=1, max_length=MAX_CAPSULES)]
    overlapping: tuple[tuple[Name, Name], ...] = ()


def read_capsules(path: Path) -> CapsuleFile:
    """Read a file; raises InputError in one line that names it."""
    table = read_toml(path, "capsules")
    bad = non_finite_key(table)
    if bad:
        raise InputError(f"capsules {path}: {bad}: must be a finite number")
    try:
        return msgspec.convert(table, CapsuleFile)
    except msgspec.ValidationError as error:
        raise InputError(f"capsules {path}: {name_key(str(error))}") from None


def capsule_text(file: CapsuleFile, heading: Iterable[str]) -> str:
    """The file as TOML, with lines of comment on top."""
    lines = [f"# {line}" for line in heading]
    pairs = ",\n".join(f'    ["{one}", "{other}"]' for one, other in file.overlapping)
    lines.append(f"overlapping = [\n{pairs},\n]" if pairs else "overlapping = []")
    for each in file.capsules:
        a, b = (", ".join(f"{x:.5f}" for x in end) for end in (each.a, each.b))
        lines += ["", "[[capsules]]", f'link = "{each.link}"']
        lines += [f"a = [{a}]", f"b = [{b}]", f"radius = {each.radius:.5f}"]
    return "\n".join(lines).replace("-0.00000", "0.00000") + "\n"


def segment_distance(a: Array, b: Array, c: Array, d: Array) -> float:
    """Distance of the segments from a to b and from c to d, (3,) each (m)."""
    u, v, w = b - a, d - c, a - c
    uu, uv, vv = float(u @ u), float(u @ v), float(v @ v)
    uw, vw = float(u @ w), float(v @ w)
    determinant = uu * vv - uv * uv
    s = min(max((uv * vw - vv * uw) / determinant, 0.0), 1.0) if determinant > 1e-12 * uu * vv else 0.0
    t = (uv * s + vw) / vv if vv > 0.0 else 0.0
    if not 0.0 <= t <= 1.0 or determinant <= 1e-12 * uu * vv:
        t = min(max(t, 0.0), 1.0)
        s = min(max((uv * t - uw) / uu, 0.0), 1.0) if uu > 0.0 else 0.0
    return float(np.linalg.norm(w + s * u - t * v))
