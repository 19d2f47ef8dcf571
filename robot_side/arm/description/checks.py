"""Whether a URDF can be used: the tree of its links, its names and its numbers."""

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from farhand.common.errors import InputError
from farhand.robot_side.arm.description.finding import nearest
from farhand.robot_side.arm.description.xml import ends, numbers, read_xml

LONGEST_NAME = 64
"""Of a robot and its joints: they are sent to those who draw it."""
SHORTEST_AXIS = 1e-6
_SIZES = {"radius": 1, "length": 1, "size": 3, "scale": 3}
"""Of collision geometry: how many numbers each has."""


def checked_root(path: Path, tool_frame: str) -> ET.Element:
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
        parent, child = ends(joint)
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


def check_names(names: Sequence[str], where: str) -> None:
    """Raise InputError unless names can be sent and shown."""
    for name in names:
        if not 1 <= len(name) <= LONGEST_NAME or not name.isprintable():
            raise InputError(f"{where}: name {name[:80]!r}: must be 1 to {LONGEST_NAME} printable characters")
