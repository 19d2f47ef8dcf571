"""A free-flying box of 1 kg in PyBullet: the simulated robot of the paper (arXiv 2403.18650)."""

from farhand.common.messages.base import Quaternion, Vector3
from farhand.robot_side.robots.bullet import GRAVITY, connect
from farhand.robot_side.robots.robot import Robot, RobotSample
from farhand.robot_side.robots.settings import RobotScenario

SIZE: Vector3 = (0.25, 0.25, 0.1)  # m
MASS = 1.0  # kg
VELOCITY_GAIN = 10.0  # 1/s: force per mass and velocity error
ATTITUDE_STIFFNESS = 400.0  # 1/s^2
ATTITUDE_DAMPING = 40.0  # 1/s


class BoxRobot(Robot):
    """Follows the velocity by f = m (10 (u - v) + g); a critically damped torque keeps it upright.

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
        self._read()

    @classmethod
    def for_scenario(cls, scenario: RobotScenario) -> "BoxRobot":
        """See Robot."""
        return cls(scenario.start)

    def sample(self) -> RobotSample:
        """The state now."""
        return RobotSample(self._position, self._velocity, self._orientation)

    def step(self, velocity: Vector3, dt: float) -> None:
        """One period of `dt` s under the commanded velocity (m/s)."""
        bullet, client, body = self._bullet, self._client, self._body
        if dt != self._dt:
            self._dt = dt
            bullet.setTimeStep(dt, physicsClientId=client)
        force = [MASS * VELOCITY_GAIN * (u - v) for u, v in zip(velocity, self._velocity, strict=True)]
        force[2] += MASS * GRAVITY
        w, *axis = self._orientation
        sign = 2.0 if w >= 0.0 else -2.0
        # Inertia about the world's axes: the box stays upright, so that they are its own.
        torque = [
            inertia * (-ATTITUDE_STIFFNESS * sign * angle - ATTITUDE_DAMPING * rate)
            for inertia, angle, rate in zip(self._inertia, axis, self._angular_velocity, strict=True)
        ]
        frame = bullet.WORLD_FRAME
        bullet.applyExternalForce(body, -1, force, self._position, frame, physicsClientId=client)
        bullet.applyExternalTorque(body, -1, torque, frame, physicsClientId=client)
        bullet.stepSimulation(physicsClientId=client)
        self._read()

    def close(self) -> None:
        """Disconnect from the physics engine."""
        if self._client >= 0:
            self._bullet.disconnect(physicsClientId=self._client)
            self._client = -1

    def _read(self) -> None:
        bullet, client = self._bullet, self._client
        position, (x, y, z, w) = bullet.getBasePositionAndOrientation(self._body, physicsClientId=client)
        velocity, angular_velocity = bullet.getBaseVelocity(self._body, physicsClientId=client)
        self._position: Vector3 = position
        self._velocity: Vector3 = velocity
        self._orientation: Quaternion = (w, x, y, z)
        self._angular_velocity: Vector3 = angular_velocity
