"""A free-flying box of 1 kg in PyBullet: the simulated robot of the paper (arXiv 2403.18650)."""

import numpy as np

from farhand.common.geometry import Twist, turn_between, turned
from farhand.common.messages.base import ZERO, Quaternion, Vector3
from farhand.robot_side.robots.bullet import GRAVITY, connect
from farhand.robot_side.robots.robot import Robot, RobotSample
from farhand.robot_side.robots.settings import RobotScenario
from farhand.robot_side.scene.surroundings import Surroundings

SIZE: Vector3 = (0.25, 0.25, 0.1)  # m
MASS = 1.0  # kg
VELOCITY_GAIN = 10.0  # 1/s: force per mass and velocity error
ATTITUDE_STIFFNESS = 400.0  # 1/s^2
ATTITUDE_DAMPING = 40.0  # 1/s
LEVEL: Quaternion = (1.0, 0.0, 0.0, 0.0)


class BoxRobot(Robot):
    """Follows the velocity by f = m (10 (u - v) + g); a critically damped torque keeps its attitude.

    The attitude to keep is level at the start; it turns as commanded, and is kept while nothing is commanded.

    Args:
        start: position (m).
    """

    catches_up = True

    def __init__(self, start: Vector3) -> None:
        self._bullet, self._client = connect()
        bullet, client = self._bullet, self._client
        half = [length / 2 for length in SIZE]
        shape = bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=half, physicsClientId=client)
        self._body = bullet.createMultiBody(MASS, shape, basePosition=start, physicsClientId=client)
        bullet.changeDynamics(self._body, -1, linearDamping=0.0, angularDamping=0.0, physicsClientId=client)
        self._inertia = bullet.getDynamicsInfo(self._body, -1, physicsClientId=client)[2]
        self._dt = 0.0
        self._attitude: Quaternion = LEVEL  # to keep
        self._read()

    @classmethod
    def for_scenario(cls, scenario: RobotScenario) -> "BoxRobot":
        """See Robot."""
        return cls(scenario.start)

    def sample(self) -> RobotSample:
        """The state now."""
        return RobotSample(
            self._position, self._velocity, self._orientation, angular_velocity=self._angular_velocity
        )

    def step(self, twist: Twist, dt: float, surroundings: Surroundings | None = None) -> None:
        """One period of `dt` s under the commanded twist."""
        bullet, client, body = self._bullet, self._client, self._body
        if dt != self._dt:
            self._dt = dt
            bullet.setTimeStep(dt, physicsClientId=client)
        (ux, uy, uz), (vx, vy, vz) = twist.linear, self._velocity
        gain = MASS * VELOCITY_GAIN
        force = (gain * (ux - vx), gain * (uy - vy), gain * (uz - vz) + MASS * GRAVITY)
        if twist.angular != ZERO:
            x, y, z = (rate * dt for rate in twist.angular)
            self._attitude = turned(self._attitude, (x, y, z))
        torque = self._upright() if self._attitude == LEVEL else self._turning(twist.angular)
        frame = bullet.WORLD_FRAME
        # by place, here and below: to look names up takes PyBullet longer than some of these calls do
        bullet.applyExternalForce(body, -1, force, self._position, frame, client)
        bullet.applyExternalTorque(body, -1, torque, frame, client)
        bullet.stepSimulation(client)
        self._read()

    def _upright(self) -> Vector3:
        """Torque towards level (Nm, world), whose axes the box's own then are: what it flies with unturned."""
        (w, x, y, z), (p, q, r), (a, b, c) = self._orientation, self._angular_velocity, self._inertia
        back, damping = -ATTITUDE_STIFFNESS * (2.0 if w >= 0.0 else -2.0), ATTITUDE_DAMPING
        return (
            a * (back * x - damping * p),
            b * (back * y - damping * q),
            c * (back * z - damping * r),
        )

    def _turning(self, angular: Vector3) -> list[float]:
        """Torque towards the attitude that turns as commanded (Nm, world)."""
        away = turn_between(self._orientation, self._attitude)
        rates = zip(away, angular, self._angular_velocity, strict=True)
        wanted = [ATTITUDE_STIFFNESS * e + ATTITUDE_DAMPING * (u - v) for e, u, v in rates]
        w, x, y, z = self._orientation
        R_world_box = np.array(self._bullet.getMatrixFromQuaternion((x, y, z, w))).reshape(3, 3)
        own: list[float] = (R_world_box @ (np.array(self._inertia) * (R_world_box.T @ wanted))).tolist()
        return own

    def close(self) -> None:
        """Disconnect from the physics engine."""
        if self._client >= 0:
            self._bullet.disconnect(physicsClientId=self._client)
            self._client = -1

    def _read(self) -> None:
        bullet, client = self._bullet, self._client
        position, (x, y, z, w) = bullet.getBasePositionAndOrientation(self._body, client)
        velocity, angular_velocity = bullet.getBaseVelocity(self._body, client)
        self._position: Vector3 = position
        self._velocity: Vector3 = velocity
        self._orientation: Quaternion = (w, x, y, z)
        self._angular_velocity: Vector3 = angular_velocity
