"""The robot for Foxglove: its links' frames from the joints' positions, and its capsules, which move with them."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from foxglove.messages import (
    Color,
    FrameTransform,
    JointState,
    JointStates,
    Quaternion,
    SceneEntity,
)

from farhand.common.messages import base
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.state import RobotState
from farhand.common.shapes.sphere import Sphere
from farhand.foxglove.figures import (
    BASE,
    TOOL,
    Place,
    along,
    capsule,
    entity,
    short,
    stamp,
    vector,
)
from farhand.robot_side.arm.capsules import read_capsules
from farhand.robot_side.arm.catalogue import ARMS, capsule_path
from farhand.robot_side.arm.description.variants import bare_text
from farhand.robot_side.arm.model import model

_LINK = Color(r=0.62, g=0.66, b=0.7, a=1.0)
_TOOL = Color(r=0.35, g=0.6, b=0.9, a=0.6)


class Body:
    """Args:
    robot: what it is; an arm that is known by name has links, anything else is a ball around its tool.
    """

    def __init__(self, robot: RobotDescription) -> None:
        self.robot = robot
        self._pin: Any = None
        if robot.model in ARMS:
            import pinocchio  # here, as a robot without links needs none

            self._pin = pinocchio
        arm = model(robot.model) if self._pin is not None else None
        self._chain: Any = self._pin.buildModelFromXML(bare_text(arm.urdf)) if arm is not None else None
        self._data: Any = self._chain.createData() if self._chain is not None else None
        self._links = (
            [
                (i, frame.name)
                for i, frame in enumerate(self._chain.frames)
                if frame.type == self._pin.FrameType.BODY
            ]
            if self._chain is not None
            else []
        )

    def frames(self, state: RobotState, time_ns: int) -> list[FrameTransform]:
        """Of the tool, and of every link."""
        found = [transform(TOOL, state.position, state.orientation, time_ns)]
        return found + [transform(name, at, turned, time_ns) for name, at, turned in self.links(state)]

    def links(self, state: RobotState) -> list[tuple[str, base.Vector3, base.Quaternion]]:
        """Every link's frame in base: name, position (m), orientation; empty: it has none that are known."""
        if self._chain is None or len(state.joints) != self._chain.nq:
            return []
        self._pin.framesForwardKinematics(self._chain, self._data, np.array(state.joints))
        found: list[tuple[str, base.Vector3, base.Quaternion]] = []
        for index, name in self._links:
            px, py, pz, x, y, z, w = self._pin.SE3ToXYZQUATtuple(self._data.oMf[index])
            found.append((name, (px, py, pz), (w, x, y, z)))
        return found

    def joints(self, state: RobotState, time_ns: int) -> JointStates:
        """Their positions (rad)."""
        pairs = zip(self.joint_names(len(state.joints)), state.joints, strict=False)
        return JointStates(
            timestamp=stamp(time_ns),
            joints=[JointState(name=name, position=short(position)) for name, position in pairs],
        )

    def joint_names(self, count: int) -> tuple[str, ...]:
        """What so many joints are called."""
        return self.robot.joint_names or tuple(f"joint{i}" for i in range(count))

    def entities(self, time_ns: int) -> list[SceneEntity]:
        """What it looks like: once, as each part moves with its frame."""
        radius = max(self.robot.radius, 1e-3)
        ball = entity("robot/tool", time_ns, Sphere(radius), Place((0.0, 0.0, 0.0), frame=TOOL), _TOOL)
        return [ball, *(self._link(name, time_ns) for name in self._parts())]

    def _parts(self) -> Sequence[str]:
        if self._chain is None:
            return ()
        known = {name for _, name in self._links}
        fitted = read_capsules(capsule_path(self.robot.model)).capsules
        return [name for name in dict.fromkeys(each.link for each in fitted) if name in known]

    def _link(self, name: str, time_ns: int) -> SceneEntity:
        spheres, cylinders = [], []
        for each in read_capsules(capsule_path(self.robot.model)).capsules:
            if each.link == name:
                half, place = along(np.array(each.a), np.array(each.b))
                balls, tubes = capsule(half, each.radius, place, _LINK)
                spheres += balls
                cylinders += tubes
        return SceneEntity(
            timestamp=stamp(time_ns),
            frame_id=name,
            id=f"robot/{name}",
            frame_locked=True,
            spheres=spheres,
            cylinders=cylinders,
        )


def transform(
    name: str, position: base.Vector3, orientation: base.Quaternion, time_ns: int
) -> FrameTransform:
    """A frame in base."""
    w, x, y, z = map(short, orientation)
    return FrameTransform(
        timestamp=stamp(time_ns),
        parent_frame_id=BASE,
        child_frame_id=name,
        translation=vector(position),
        rotation=Quaternion(x=x, y=y, z=z, w=w),
    )
