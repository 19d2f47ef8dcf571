"""A view of the simulated robot and its scene, drawn from its states by PyBullet in a world of this program's own."""

import math
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from farhand.common.messages.scene import Obstacle, Scene
from farhand.common.messages.state import RobotState
from farhand.common.shapes.obstacle import moved
from farhand.common.shapes.plane import Plane
from farhand.robot_side.arm.model import ArmModel
from farhand.robot_side.camera.ground import Eye, backdrop
from farhand.robot_side.camera.lit_meshes import with_lit_meshes
from farhand.robot_side.camera.settings import VIEW, CameraSettings, Pictures
from farhand.robot_side.camera.source import Seen, Shot
from farhand.robot_side.camera.strip import Picture
from farhand.robot_side.robots.arms import chosen_arm
from farhand.robot_side.robots.bullet import connect, quiet
from farhand.robot_side.robots.bullet_obstacles import BulletObstacles
from farhand.robot_side.robots.settings import RobotSettings

NEAR, FAR = 0.02, 20.0  # m; what is nearer or farther is not drawn
_LINK, _OTHER_LINK, _OBSTACLE = (0.86, 0.88, 0.92, 1.0), (0.43, 0.73, 0.93, 1.0), (0.91, 0.64, 0.09, 1.0)
_ARMS = ("arm", "ur5")


class BulletView:
    """Draws what the newest state says; nothing twice, so that no old picture gets a new stamp.

    Args:
        robot: which one it is.
        settings: where it is seen from.
        pictures: how large.

    Raises:
        ScenarioError: there is no such arm.
    """

    def __init__(self, robot: RobotSettings, settings: CameraSettings, pictures: Pictures) -> None:
        self.name = VIEW
        self.trouble = ""
        self._size = pictures.width, pictures.height
        self._arm = chosen_arm(robot) if robot.kind in _ARMS else None
        self._eye = eye_of(settings)
        self._planes: tuple[Obstacle, ...] = ()
        self._backdrop = backdrop(self._eye, *self._size)
        self._bullet, self._client = connect()
        self._body, self._joints = self._load(self._arm, robot.radius)
        self._obstacles = _DrawnObstacles(self._bullet, self._client, self._body)
        self._matrices = self._projection(settings)
        self._drawn = (0, -1)

    def shoot(self, seen: Seen) -> Shot | None:
        """See CameraSource; the capture is the instant at which the state that is drawn was sampled."""
        state = seen.state
        if state is None or (state.session, state.seq) == self._drawn:
            self.trouble = (
                "no state comes from the robot" if state is None else "no new state comes from the robot"
            )
            return None
        if len(state.joints) != len(self._joints):
            self.trouble = f"the robot has {len(state.joints)} joints, and the scenario's {len(self._joints)}"
            return None
        self.trouble = ""
        self._drawn = state.session, state.seq
        self._pose(state)
        self._place(_obstacles_at(seen.scene, state.t_sample_ns))
        return Shot(self._picture(), state.session, state.t_sample_ns)

    def close(self) -> None:
        """See CameraSource."""
        if self._client >= 0:
            self._bullet.disconnect(physicsClientId=self._client)
            self._client = -1

    def _load(self, arm: ArmModel | None, radius: float) -> tuple[int, list[int]]:
        """The robot's body, and the indices of its joints."""
        bullet, client = self._bullet, self._client
        if arm is None:
            shape = bullet.createCollisionShape(
                bullet.GEOM_SPHERE, radius=max(radius, 0.01), physicsClientId=client
            )
            body: int = bullet.createMultiBody(0.0, shape, physicsClientId=client)
            bullet.changeVisualShape(body, -1, rgbaColor=_LINK, physicsClientId=client)
            return body, []
        with tempfile.TemporaryDirectory() as folder, quiet():
            path = Path(folder) / "arm.urdf"
            path.write_text(with_lit_meshes(arm.urdf, Path(folder)), encoding="utf-8")
            body = bullet.loadURDF(str(path), useFixedBase=True, physicsClientId=client)
        joints: dict[str, int] = {}
        for index in range(bullet.getNumJoints(body, physicsClientId=client)):
            joints[bullet.getJointInfo(body, index, physicsClientId=client)[1].decode()] = index
        for index in range(-1, len(joints)):
            colour = _OTHER_LINK if index % 3 == 2 else _LINK
            bullet.changeVisualShape(body, index, rgbaColor=colour, physicsClientId=client)
        return body, [joints[name] for name in arm.joint_names]

    def _projection(self, settings: CameraSettings) -> dict[str, Any]:
        bullet, (width, height) = self._bullet, self._size
        return {
            "viewMatrix": bullet.computeViewMatrix(settings.eye, settings.look_at, settings.up),
            "projectionMatrix": bullet.computeProjectionMatrixFOV(
                math.degrees(settings.field_of_view), width / height, NEAR, FAR
            ),
        }

    def _pose(self, state: RobotState) -> None:
        bullet, client = self._bullet, self._client
        for index, angle in zip(self._joints, state.joints, strict=True):
            bullet.resetJointState(self._body, index, angle, physicsClientId=client)
        if self._arm is None:
            w, x, y, z = state.orientation
            bullet.resetBasePositionAndOrientation(
                self._body, state.position, (x, y, z, w), physicsClientId=client
            )

    def _place(self, obstacles: tuple[Obstacle, ...]) -> None:
        planes = tuple(each for each in obstacles if isinstance(each.shape, Plane))
        if planes != self._planes:
            self._planes, self._backdrop = planes, backdrop(self._eye, *self._size, planes)
        self._obstacles.show(tuple(each for each in obstacles if not isinstance(each.shape, Plane)))

    def _picture(self) -> Picture:
        """What is drawn, before its backdrop: whichever is nearer to the eye."""
        bullet, (width, height) = self._bullet, self._size
        _, _, colours, depths, _ = bullet.getCameraImage(
            width,
            height,
            **self._matrices,
            shadow=0,
            renderer=bullet.ER_TINY_RENDERER,
            flags=bullet.ER_NO_SEGMENTATION_MASK,
            physicsClientId=self._client,
        )
        drawn = np.asarray(colours, np.uint8).reshape(height, width, 4)
        buffer = np.asarray(depths, np.float32).reshape(height, width)
        depth = FAR * NEAR / (FAR - (FAR - NEAR) * buffer)
        there = (buffer < 1.0) & (depth < self._backdrop.depth)
        return np.where(there[:, :, None], drawn, self._backdrop.picture)


class _DrawnObstacles(BulletObstacles):
    """Obstacles that are looked at instead of measured."""

    def show(self, obstacles: tuple[Obstacle, ...]) -> None:
        """Put them where they are."""
        before = list(self._solids)
        self._place(obstacles)
        if self._solids != before:
            for solid in self._solids:
                self._bullet.changeVisualShape(solid, -1, rgbaColor=_OBSTACLE, physicsClientId=self._client)


def eye_of(settings: CameraSettings) -> Eye:
    """The camera of a view."""
    position = np.array(settings.eye)
    forward = np.array(settings.look_at) - position
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, np.array(settings.up))
    right /= np.linalg.norm(right)
    return Eye(position, right, np.cross(right, forward), forward, math.tan(settings.field_of_view / 2.0))


def _obstacles_at(scene: Scene | None, now_ns: int) -> tuple[Obstacle, ...]:
    """Where they are at an instant of the robot's clock."""
    if scene is None:
        return ()
    seconds = (now_ns - scene.t_sample_ns) * 1e-9
    return tuple(moved(each, seconds) for each in scene.obstacles)
