"""A URDF read for one arm: the serial chain to its tool frame, and a text that physics and kinematics can load.

What moves beside the chain, such as the fingers of a gripper, is fixed where its joint stands at zero.
"""

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from farhand.common.errors import InputError
from farhand.common.geometry import Array
from farhand.robot_side.arm.description.checks import check_names, checked_root
from farhand.robot_side.arm.description.finding import installed
from farhand.robot_side.arm.description.xml import ends, numbers, read_xml

LEAST_JOINTS, MOST_JOINTS = 6, 7
_PACKAGE, _FILE = "package://", "file://"
_MOVES = ("revolute", "continuous", "prismatic", "planar", "floating")


@dataclass(frozen=True, slots=True)
class Chain:
    """What an arm needs of a URDF.

    Attributes:
        name: of the robot.
        text: the URDF without visuals, meshes by absolute path, everything beside the chain fixed.
        joint_names: of the chain, from the base on.
        lower, upper: (n,) position limits (rad).
        max_velocity: (n,) rad/s.
        max_torque: (n,) N m.
        adjacent: pairs of links that a joint, or a row of fixed ones, holds together.
        standing: links that no joint moves.
    rigid: pairs of links that fixed joints hold together.
    """

    name: str
    text: str
    joint_names: tuple[str, ...]
    lower: Array
    upper: Array
    max_velocity: Array
    max_torque: Array
    adjacent: frozenset[frozenset[str]]
    standing: frozenset[str]
    rigid: frozenset[frozenset[str]]


def read_urdf(path: Path, tool_frame: str) -> Chain:
    """The chain from the base to a link.

    Args:
        path: the file.
        tool_frame: name of the link that is the tool's frame.

    Raises InputError when the file cannot be read, the chain is none of 6 or 7 revolute joints with limits, or a mesh
    is missing.
    """
    where = f"URDF {path}"
    root = checked_root(path, tool_frame)
    links = [link.get("name", "") for link in root.findall("link")]
    joints = root.findall("joint")
    chain = _chain(joints, tool_frame)
    for joint in joints:
        if joint not in chain and joint.get("type") in _MOVES:
            _fix(joint)
    moving = [joint for joint in chain if joint.get("type") != "fixed"]
    limits = np.array([_limits(joint, where) for joint in moving]).reshape(-1, 4)
    if not LEAST_JOINTS <= len(moving) <= MOST_JOINTS:
        raise InputError(
            f"{where}: {len(moving)} revolute joints lead to {tool_frame!r}; {LEAST_JOINTS} or {MOST_JOINTS} are needed"
        )
    names = [root.get("name") or path.stem, *(joint.get("name", "") for joint in moving)]
    check_names(names, where)
    _without_visuals(root, path)
    lower, upper, velocity, torque = limits.T
    bodies = _bodies(joints, links)
    return Chain(
        name=names[0],
        text=ET.tostring(root, encoding="unicode"),
        joint_names=tuple(names[1:]),
        lower=lower,
        upper=upper,
        max_velocity=velocity,
        max_torque=torque,
        adjacent=_adjacent(bodies, joints),
        standing=frozenset(bodies[ends(moving[0])[0]]),
        rigid=_adjacent(bodies, []),
    )


def tool_frame_of(path: Path) -> str:
    """The one link at the end of the arm where nobody says which it is; raises InputError when several could be."""
    root = read_xml(path, "URDF")
    parents = {ends(joint)[0] for joint in root.findall("joint")}
    tips = [link.get("name", "") for link in root.findall("link") if link.get("name") not in parents]
    if len(tips) != 1:
        raise InputError(
            f"URDF {path}: no tool frame: set robot.tool_frame to one of its links, such as {', '.join(tips[:6])}"
        )
    return tips[0]


def _chain(joints: list[ET.Element], tool_frame: str) -> list[ET.Element]:
    """The joints from the base to the tool frame."""
    above = {ends(joint)[1]: joint for joint in joints}
    found: list[ET.Element] = []
    link = tool_frame
    while link in above:
        joint = above[link]
        found.append(joint)
        link = ends(joint)[0]
    return found[::-1]


def _limits(joint: ET.Element, where: str) -> tuple[float, float, float, float]:
    """Lower, upper, velocity, effort."""
    name, kind = joint.get("name"), joint.get("type")
    if kind == "continuous":
        raise InputError(
            f"{where}: joint {name!r}: turns without limits; make it revolute and give it limits"
        )
    if kind != "revolute":
        raise InputError(
            f"{where}: joint {name!r}: is {kind}; the chain to the tool must be of revolute joints"
        )
    if joint.find("mimic") is not None:
        raise InputError(f"{where}: joint {name!r}: mimics another; every joint of the chain must be driven")
    limit = joint.find("limit")
    missing = [k for k in ("lower", "upper", "velocity", "effort") if limit is None or limit.get(k) is None]
    if limit is None or missing:
        raise InputError(f"{where}: joint {name!r}: has no limit: {', '.join(missing)}")
    try:
        lower, upper, velocity, effort = (
            float(numbers(limit, key, size=1)[0]) for key in ("lower", "upper", "velocity", "effort")
        )
    except InputError as error:
        raise InputError(f"{where}: joint {name!r}: {error}") from None
    if not lower < upper or velocity <= 0.0 or effort <= 0.0:
        raise InputError(
            f"{where}: joint {name!r}: limits must have lower < upper, and velocity and effort above 0"
        )
    return lower, upper, velocity, effort


def _fix(joint: ET.Element) -> None:
    joint.set("type", "fixed")
    for part in ("axis", "limit", "mimic", "dynamics", "safety_controller", "calibration"):
        for element in joint.findall(part):
            joint.remove(element)


def _bodies(joints: list[ET.Element], links: list[str]) -> dict[str, set[str]]:
    """Each link's rigid body: the links that fixed joints hold to it, and itself."""
    body = {link: {link} for link in links}
    for joint in joints:
        if joint.get("type") == "fixed":
            parent, child = ends(joint)
            together = body[parent] | body[child]
            for link in together:
                body[link] = together
    return body


def _adjacent(bodies: dict[str, set[str]], joints: list[ET.Element]) -> frozenset[frozenset[str]]:
    """Links of one rigid body, and of the two bodies that a joint holds together."""
    groups = [(body, body) for body in bodies.values()]
    groups += [(bodies[parent], bodies[child]) for parent, child in map(ends, joints)]
    return frozenset(frozenset((a, b)) for one, other in groups for a in one for b in other if a != b)


def _without_visuals(root: ET.Element, path: Path) -> None:
    """Take out the visuals, which take a second to load, and give the meshes' absolute paths."""
    for link in root.iter("link"):
        for visual in link.findall("visual"):
            link.remove(visual)
        for mesh in link.iter("mesh"):
            mesh.set("filename", str(_mesh(mesh.get("filename", ""), path, link.get("name", ""))))


def _mesh(name: str, path: Path, link: str) -> Path:
    """Where a mesh lies: beside the URDF, in a folder of the package's name above it, or in a Python package of it."""
    folder = path.resolve().parent
    if name.startswith(_PACKAGE):
        package, _, rest = name.removeprefix(_PACKAGE).partition("/")
        places = [above / rest for above in (folder, *folder.parents) if above.name == package]
        places += [above / package / rest for above in (folder, *folder.parents)]
        there = installed(package)
        places += [there / rest] if there is not None else []
    else:
        places = [folder / name.removeprefix(_FILE)]
    for place in places:
        if place.is_file():
            return place
    raise InputError(
        f"URDF {path}: link {link!r}: mesh {name}: no such file, beside the URDF or in a folder above it"
    )
