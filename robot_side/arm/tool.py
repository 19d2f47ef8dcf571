"""What the user puts on an arm: a gripper, a part in it, as one capsule or sphere in the tool's frame."""

import dataclasses
import xml.etree.ElementTree as ET

import numpy as np

from farhand.common.errors import InputError
from farhand.common.geometry import Array
from farhand.robot_side.arm.capsules import LinkCapsule
from farhand.robot_side.arm.description.xml import rpy_of_axis
from farhand.robot_side.arm.model import ArmModel, pairs_to_keep_apart

TOOL = "tool"


def with_tool(arm: ArmModel, start: Array, end: Array, radius: float) -> ArmModel:
    """The arm with a capsule on it, a sphere where both ends are the same. It weighs nothing.

    The tool is kept apart from all parts that it does not move with and does not overlap at home.

    Args:
        arm: without a tool.
        start, end: (3,) of the capsule's segment in the tool's frame (m).
        radius: in m.

    Raises InputError when it is larger than the arm's own reach, or a link of the arm is called `tool`.
    """
    farthest = max(float(np.linalg.norm(start)), float(np.linalg.norm(end))) + radius
    if farthest > arm.longest_reach:
        raise InputError(
            f"reaches {farthest:.2f} m from the tool frame, farther than the {arm.title} itself "
            f"({arm.longest_reach:.2f} m)"
        )
    root = ET.fromstring(arm.urdf)
    if any(link.get("name") == TOOL for link in root.iter("link")):
        raise InputError(f"the {arm.title} has a link that is called {TOOL!r} already")
    a, b = (arm.R_last_tool @ point + arm.p_last_tool for point in (start, end))
    capsules = (*arm.capsules, LinkCapsule(TOOL, arm.n - 1, a, b, radius))
    last = len(capsules) - 1
    pairs = pairs_to_keep_apart(capsules, ())
    tried = dataclasses.replace(
        arm, capsules=capsules, self_pairs=tuple(pair for pair in pairs if last in pair)
    )
    gaps = tried.self_gaps(arm.home)
    apart = tuple(pair for pair, gap in zip(tried.self_pairs, gaps, strict=True) if gap > 0.0)
    kept = {capsules[i].part for i, _ in apart}
    beside = {frozenset((TOOL, link.get("name", ""))) for link in root.iter("link")}
    return dataclasses.replace(
        tried,
        urdf=_urdf_with_tool(root, arm.tool_frame, start, end, radius),
        self_pairs=arm.self_pairs + apart,
        never_colliding=arm.never_colliding | {pair for pair in beside if not pair & kept},
    )


def _urdf_with_tool(root: ET.Element, tool_frame: str, start: Array, end: Array, radius: float) -> str:
    """The URDF with one more link, fixed to the tool's frame."""
    along = end - start
    length = float(np.linalg.norm(along))
    rpy = rpy_of_axis(along / length) if length > 0.0 else np.zeros(3)
    link = ET.SubElement(root, "link", name=TOOL)
    inertial = ET.SubElement(link, "inertial")
    ET.SubElement(inertial, "mass", value="0")
    none = dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), "0")
    ET.SubElement(inertial, "inertia", none)
    collision = ET.SubElement(link, "collision")
    ET.SubElement(collision, "origin", xyz=_words((start + end) / 2.0), rpy=_words(rpy))
    geometry = ET.SubElement(collision, "geometry")
    if length > 0.0:
        ET.SubElement(geometry, "capsule", radius=repr(radius), length=repr(length))
    else:
        ET.SubElement(geometry, "sphere", radius=repr(radius))
    joint = ET.SubElement(root, "joint", name=f"{TOOL}_joint", type="fixed")
    ET.SubElement(joint, "parent", link=tool_frame)
    ET.SubElement(joint, "child", link=TOOL)
    return ET.tostring(root, encoding="unicode")


def _words(vector: Array) -> str:
    return " ".join(repr(float(x)) for x in vector)
