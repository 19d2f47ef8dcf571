"""A URDF read for one arm: the serial chain to its tool frame, and a text that physics and kinematics can load.

What moves beside the chain, such as the fingers of a gripper, is fixed where its joint stands at zero.
"""

import math
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from farhand.common.errors import InputError
from farhand.common.geometry import Array
from farhand.robot_side.arm.catalogue import installed, nearest

LEAST_JOINTS, MOST_JOINTS = 6, 7
LONGEST_NAME = 64
"""Of a robot and its joints: they are sent to those who draw it."""
SHORTEST_AXIS = 1e-6
_SIZES = {"radius": 1, "length": 1, "size": 3, "scale": 3}
"""Of collision geometry: how many numbers each has."""
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
    root = _checked_root(path, tool_frame)
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
    _check_names(names, where)
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
        standing=frozenset(bodies[_ends(moving[0])[0]]),
        rigid=_adjacent(bodies, []),
    )


@lru_cache(maxsize=8)
def bare_text(text: str) -> str:
    """The same URDF without shapes, some of which Pinocchio's parser does not know and complains about."""
    root = ET.fromstring(text)
    for link in root.iter("link"):
        for collision in link.findall("collision"):
            link.remove(collision)
    return ET.tostring(root, encoding="unicode")


@lru_cache(maxsize=8)
def massive_text(text: str) -> str:
    """The same URDF without the links at its ends that have neither mass nor shape: frames, of which physics knows
    nothing, and which cost it as much as any other link in every step. At its foot only one that the next link sits on
    as it is, so that nothing is placed elsewhere."""
    root = ET.fromstring(text)
    _drop_foot(root)
    links = {link.get("name", ""): link for link in root.findall("link")}
    while True:
        parents = {_linked(joint, "parent") for joint in root.findall("joint")}
        bare = [
            joint
            for joint in root.findall("joint")
            if joint.get("type") == "fixed"
            and (child := _linked(joint, "child")) not in parents
            and _is_frame(links[child])
        ]
        if not bare:
            return ET.tostring(root, encoding="unicode")
        for joint in bare:
            root.remove(joint)
            root.remove(links[_linked(joint, "child")])


@lru_cache(maxsize=8)
def first_link(text: str) -> str:
    """The name of the link that hangs on no other."""
    return _foot(ET.fromstring(text)).get("name", "")


def _foot(root: ET.Element) -> ET.Element:
    children = {_linked(joint, "child") for joint in root.findall("joint")}
    return next(link for link in root.findall("link") if link.get("name", "") not in children)


def _drop_foot(root: ET.Element) -> None:
    """Remove the first link, if it is a frame on which one link stands fast, at its origin and not turned."""
    foot = _foot(root)
    on_it = [joint for joint in root.findall("joint") if _linked(joint, "parent") == foot.get("name")]
    if len(on_it) != 1 or on_it[0].get("type") != "fixed" or not _is_frame(foot):
        return
    origin = on_it[0].find("origin")
    placed = [] if origin is None else [*origin.get("xyz", "").split(), *origin.get("rpy", "").split()]
    if not any(map(float, placed)):
        root.remove(on_it[0])
        root.remove(foot)


def _linked(joint: ET.Element, end: str) -> str:
    found = joint.find(end)
    return "" if found is None else found.get("link", "")


def _is_frame(link: ET.Element) -> bool:
    mass = link.find("inertial/mass")
    weighs = mass is not None and float(mass.get("value", "0")) != 0.0
    return not weighs and link.find("collision") is None


def _checked_root(path: Path, tool_frame: str) -> ET.Element:
    """The robot, all of whose joints have their links; raises InputError."""
    where = f"URDF {path}"
    root = read_xml(path, "URDF")
    if root.tag != "robot":
        raise InputError(f"{where}: is no URDF: its root is <{root.tag}>, not <robot>")
    if any("xacro" in element.tag for element in root.iter()):
        raise InputError(f"{where}: is xacro; expand it first: xacro FILE > arm.urdf")
    if not root.get("name"):
        root.set("name", path.stem)
    links = _names(root, "link", where)
    _names(root, "joint", where)
    if tool_frame not in links:
        raise InputError(f"{where}: tool frame {tool_frame!r}: no such link; {nearest(tool_frame, links)}")
    _check_tree(root, links, where)
    for part in ("link", "joint"):
        for element in root.findall(part):
            try:
                _check_numbers(element)
            except InputError as error:
                raise InputError(f"{where}: {part} {element.get('name')!r}: {error}") from None
    return root


def _names(root: ET.Element, part: str, where: str) -> list[str]:
    """Names of all links or all joints; raises InputError where one is missing or there twice."""
    names = [element.get("name", "") for element in root.findall(part)]
    for name in names:
        if not name or names.count(name) > 1:
            raise InputError(f"{where}: {part} {name!r}: {'is there twice' if name else 'has no name'}")
    return names


def _check_tree(root: ET.Element, links: list[str], where: str) -> None:
    """Raise InputError unless the joints hold all links together as a tree."""
    parents: dict[str, str] = {}
    for joint in root.findall("joint"):
        parent, child = _ends(joint)
        for end in (parent, child):
            if end not in links:
                raise InputError(f"{where}: joint {joint.get('name')!r}: its link {end!r} is not there")
        if child in parents:
            raise InputError(
                f"{where}: joint {joint.get('name')!r}: its link {child!r} hangs on another joint already"
            )
        parents[child] = parent
    free = [link for link in links if link not in parents]
    if len(free) > 1:
        raise InputError(f"{where}: link {free[1]!r}: no joint holds it")
    for link in links:
        for _ in links:
            link = parents.get(link, link)
        if link in parents:
            raise InputError(f"{where}: the joints form a circle with link {link!r}")


def _check_numbers(element: ET.Element) -> None:
    """Raise InputError unless what a link or a joint says in numbers are numbers that can be."""
    for origin in element.iter("origin"):
        numbers(origin, "xyz", (0.0, 0.0, 0.0))
        numbers(origin, "rpy", (0.0, 0.0, 0.0))
    for axis in element.findall("axis"):
        if float(np.linalg.norm(numbers(axis, "xyz", (1.0, 0.0, 0.0)))) < SHORTEST_AXIS:
            raise InputError(f"<axis>: xyz={axis.get('xyz')!r}: has no direction")
    for mass in element.findall("inertial/mass"):
        numbers(mass, "value", size=1)
    for inertia in element.findall("inertial/inertia"):
        for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"):
            numbers(inertia, key, (0.0,), size=1)
    for shape in element.findall("collision/geometry/*"):
        for key in set(_SIZES) & set(shape.keys()):
            if float(numbers(shape, key, size=_SIZES[key]).min()) <= 0.0:
                raise InputError(f"<{shape.tag}>: {key}={shape.get(key)!r}: must be above 0")


def _check_names(names: Sequence[str], where: str) -> None:
    for name in names:
        if not 1 <= len(name) <= LONGEST_NAME or not name.isprintable():
            raise InputError(f"{where}: name {name[:80]!r}: must be 1 to {LONGEST_NAME} printable characters")


def tool_frame_of(path: Path) -> str:
    """The one link at the end of the arm where nobody says which it is; raises InputError when several could be."""
    root = read_xml(path, "URDF")
    parents = {_ends(joint)[0] for joint in root.findall("joint")}
    ends = [link.get("name", "") for link in root.findall("link") if link.get("name") not in parents]
    if len(ends) != 1:
        raise InputError(
            f"URDF {path}: no tool frame: set robot.tool_frame to one of its links, such as {', '.join(ends[:6])}"
        )
    return ends[0]


def read_xml(path: Path, what: str) -> ET.Element:
    """The root of an XML file; raises InputError with `what` the file is as its first word."""
    try:
        return ET.parse(path).getroot()
    except OSError as error:
        raise InputError(f"{what} {path}: cannot be read: {error.strerror or error}") from None
    except (ET.ParseError, UnicodeError, ValueError) as error:
        raise InputError(f"{what} {path}: is not valid XML: {error}") from None


def numbers(element: ET.Element, key: str, default: Sequence[float] | None = None, *, size: int = 3) -> Array:
    """(size,) numbers of an attribute; raises InputError when they are none, or too many or few."""
    text = element.get(key)
    if text is None:
        if default is None:
            raise InputError(f"<{element.tag}>: {key} is missing")
        return np.array(default, dtype=float)
    try:
        found = np.array([float(word) for word in text.split()])
    except ValueError:
        found = np.array([math.nan])
    if len(found) != size or not np.isfinite(found).all():
        raise InputError(f"<{element.tag}>: {key}={text!r}: expected {size} finite number{'s' * (size > 1)}")
    return found


def rotation_rpy(rpy: Array) -> Array:
    """(3, 3) rotation of a URDF's roll, pitch and yaw (rad): about the fixed axes x, y, z in turn."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rpy_of_axis(axis: Array) -> Array:
    """(3,) roll, pitch and yaw (rad) of a frame whose z axis is the unit vector (3,)."""
    x, y, z = axis
    return np.array([0.0, np.arctan2(np.hypot(x, y), z), np.arctan2(y, x)])


def _ends(joint: ET.Element) -> tuple[str, str]:
    parent, child = joint.find("parent"), joint.find("child")
    return (
        parent.get("link", "") if parent is not None else "",
        child.get("link", "") if child is not None else "",
    )


def _chain(joints: list[ET.Element], tool_frame: str) -> list[ET.Element]:
    """The joints from the base to the tool frame."""
    above = {_ends(joint)[1]: joint for joint in joints}
    found: list[ET.Element] = []
    link = tool_frame
    while link in above:
        joint = above[link]
        found.append(joint)
        link = _ends(joint)[0]
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
            parent, child = _ends(joint)
            together = body[parent] | body[child]
            for link in together:
                body[link] = together
    return body


def _adjacent(bodies: dict[str, set[str]], joints: list[ET.Element]) -> frozenset[frozenset[str]]:
    """Links of one rigid body, and of the two bodies that a joint holds together."""
    groups = [(body, body) for body in bodies.values()]
    groups += [(bodies[parent], bodies[child]) for parent, child in map(_ends, joints)]
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
