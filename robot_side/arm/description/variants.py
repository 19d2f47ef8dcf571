"""The same URDF for those who need less of it: kinematics without shapes, physics without frames."""

import xml.etree.ElementTree as ET
from functools import lru_cache

from farhand.robot_side.arm.description.xml import ends


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
        parents = {ends(joint)[0] for joint in root.findall("joint")}
        bare = [
            joint
            for joint in root.findall("joint")
            if joint.get("type") == "fixed"
            and (child := ends(joint)[1]) not in parents
            and _is_frame(links[child])
        ]
        if not bare:
            return ET.tostring(root, encoding="unicode")
        for joint in bare:
            root.remove(joint)
            root.remove(links[ends(joint)[1]])


@lru_cache(maxsize=8)
def first_link(text: str) -> str:
    """The name of the link that hangs on no other."""
    return _foot(ET.fromstring(text)).get("name", "")


def _foot(root: ET.Element) -> ET.Element:
    children = {ends(joint)[1] for joint in root.findall("joint")}
    return next(link for link in root.findall("link") if link.get("name", "") not in children)


def _drop_foot(root: ET.Element) -> None:
    """Remove the first link, if it is a frame on which one link stands fast, at its origin and not turned."""
    foot = _foot(root)
    on_it = [joint for joint in root.findall("joint") if ends(joint)[0] == foot.get("name")]
    if len(on_it) != 1 or on_it[0].get("type") != "fixed" or not _is_frame(foot):
        return
    origin = on_it[0].find("origin")
    placed = [] if origin is None else [*origin.get("xyz", "").split(), *origin.get("rpy", "").split()]
    if not any(map(float, placed)):
        root.remove(on_it[0])
        root.remove(foot)


def _is_frame(link: ET.Element) -> bool:
    mass = link.find("inertial/mass")
    weighs = mass is not None and float(mass.get("value", "0")) != 0.0
    return not weighs and link.find("collision") is None
