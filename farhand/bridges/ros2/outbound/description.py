"""A known arm for ROS: its URDF as RViz takes it, and its links' frames, those that stand and those that move."""

import xml.etree.ElementTree as ElementTree

import numpy as np
from msgspec.structs import replace

from farhand.bridges.ros2.cdr.frames import Frame
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.state import RobotState
from farhand.foxglove.body import Body
from farhand.foxglove.figures import BASE, PREDICTED, TOOL
from farhand.robot_side.arm.catalogue import ARMS
from farhand.robot_side.arm.model import model

OWN = (BASE, TOOL, PREDICTED)
"""Farhand's frames. A link of the same name, such as the UR's `base`, which is turned by half a turn, gets another."""


def link_name(name: str) -> str:
    """What a link is called in ROS."""
    return f"urdf_{name}" if name in OWN else name


class ArmFrames:
    """Args:
    robot: what it is; one that is not known by its model has no links.
    """

    def __init__(self, robot: RobotDescription) -> None:
        self.robot = robot
        self._body = Body(robot)
        self._standing: set[str] = set()

    def names(self, count: int) -> tuple[str, ...]:
        """What so many joints are called."""
        return self._body.joint_names(count)

    def standing(self, state: RobotState) -> list[Frame]:
        """Links that no joint moves, in base; looked at once."""
        here = self._named(state)
        turned = replace(state, joints=tuple(q + 0.3 for q in state.joints))
        there = {name: (at, way) for name, at, way in self._named(turned)}
        found = [
            each for each in here if np.allclose(np.hstack(there[each[0]]), np.hstack(each[1:]), atol=1e-9)
        ]
        self._standing = {name for name, _, _ in found}
        return found

    def moving(self, state: RobotState) -> list[Frame]:
        """The tool, and the other links, in base."""
        tool: Frame = (TOOL, state.position, state.orientation)
        return [tool, *(each for each in self._named(state) if each[0] not in self._standing)]

    def _named(self, state: RobotState) -> list[Frame]:
        return [(link_name(name), at, way) for name, at, way in self._body.links(state)]

    def urdf(self) -> str:
        """Its text; empty: there is none that is known."""
        if self.robot.model not in ARMS:
            return ""
        root = ElementTree.fromstring(model(self.robot.model).urdf)
        for other in ("transmission", "gazebo"):
            for each in root.findall(other):
                root.remove(each)
        for link in root.iter("link"):
            link.set("name", link_name(link.get("name", "")))
            for collision in link.findall("collision"):
                collision.tag = "visual"
        for joint in root.iter("joint"):
            for end in (*joint.findall("parent"), *joint.findall("child")):
                end.set("link", link_name(end.get("link", "")))
        for mesh in root.iter("mesh"):
            name = mesh.get("filename", "")
            mesh.set("filename", f"file://{name}" if name.startswith("/") else name)
        return ElementTree.tostring(root, encoding="unicode")
