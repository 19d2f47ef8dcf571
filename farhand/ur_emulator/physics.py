"""The emulated arm: PyBullet, the joints' drives after the controller's set point."""

import tempfile
from pathlib import Path

import numpy as np

from farhand.common.geometry import Array
from farhand.robot_side.arm.model import ArmModel
from farhand.robot_side.robots.bullet import connect, quiet

FOLLOWING = 20.0
"""1/s: how strongly a drive takes back what it is away from its set point."""
LONGEST_STEP = 0.002
"""s, of the physics; a longer cycle is several steps."""


class Physics:
    """The arm in a world of its own, without anything it could hit.

    Args:
        arm: its URDF and torques.
        q: (n,) where it stands (rad).

    Attributes:
        q, qd: (n,) where the joints are and how fast (rad, rad/s).
    """

    def __init__(self, arm: ArmModel, q: Array) -> None:
        self._bullet, self._client = connect()
        bullet, client = self._bullet, self._client
        bullet.setPhysicsEngineParameter(solverResidualThreshold=1e-12, physicsClientId=client)
        with tempfile.TemporaryDirectory() as folder, quiet():
            path = Path(folder) / "arm.urdf"
            path.write_text(arm.urdf, encoding="utf-8")
            flags = bullet.URDF_USE_INERTIA_FROM_FILE
            self._body = bullet.loadURDF(str(path), useFixedBase=True, flags=flags, physicsClientId=client)
        names = {
            bullet.getJointInfo(self._body, i, physicsClientId=client)[1].decode(): i
            for i in range(bullet.getNumJoints(self._body, physicsClientId=client))
        }
        self._joints = [names[name] for name in arm.joint_names]
        for index, angle in zip(self._joints, q, strict=True):
            bullet.resetJointState(self._body, index, float(angle), physicsClientId=client)
        self._forces = arm.max_torque.tolist()
        self._dt = 0.0
        self.q: Array = np.array(q, dtype=float)
        self.qd: Array = np.zeros(arm.n)

    def step(self, q: Array, qd: Array, dt: float) -> None:
        """One cycle of `dt` s after the set point q, qd (n,)."""
        bullet, client = self._bullet, self._client
        steps = max(1, round(dt / LONGEST_STEP))
        if dt != self._dt:
            self._dt = dt
            bullet.setTimeStep(dt / steps, physicsClientId=client)
        # a drive without an error of its own lets a resting arm creep; with one it does not
        targets = (qd + FOLLOWING * (q - dt * qd - self.q)).tolist()
        for _ in range(steps):
            bullet.setJointMotorControlArray(
                self._body,
                self._joints,
                bullet.VELOCITY_CONTROL,
                targetVelocities=targets,
                forces=self._forces,
                physicsClientId=client,
            )
            bullet.stepSimulation(physicsClientId=client)
        states = bullet.getJointStates(self._body, self._joints, physicsClientId=client)
        self.q = np.array([state[0] for state in states])
        self.qd = np.array([state[1] for state in states])

    def close(self) -> None:
        """Disconnect from the physics engine."""
        if self._client >= 0:
            self._bullet.disconnect(physicsClientId=self._client)
            self._client = -1
