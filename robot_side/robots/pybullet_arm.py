"""An arm in PyBullet: joint velocity motors with the arm's torque limits, inertias from the file."""

import tempfile
from collections.abc import Sequence
from itertools import combinations
from pathlib import Path
from struct import Struct

import numpy as np

from farhand.common.errors import ScenarioError
from farhand.common.geometry import STILL, Array, Twist
from farhand.common.messages.intervention import Intervention
from farhand.common.messages.scene import Obstacle
from farhand.common.quantities import Vector3
from farhand.robot_side.arm.chain import ArmChain
from farhand.robot_side.arm.holder import holder
from farhand.robot_side.arm.holder import prepare as prepare_holder
from farhand.robot_side.arm.kinematics import Kinematics
from farhand.robot_side.arm.limits import JointBounds
from farhand.robot_side.arm.model import ArmModel
from farhand.robot_side.arm.velocity_control import DampedLeastSquares, DirectionKeeping, VelocityControl
from farhand.robot_side.kernel.body import moved_at_most
from farhand.robot_side.robots.arms import chosen_arm
from farhand.robot_side.robots.bullet import connect, quiet
from farhand.robot_side.robots.bullet_obstacles import BulletObstacles
from farhand.robot_side.robots.robot import Robot, RobotSample
from farhand.robot_side.robots.settings import RobotScenario
from farhand.robot_side.safety.guard.arm_guard import ArmGuard, Joints
from farhand.robot_side.safety.guard.arm_start import check_arm_clear
from farhand.robot_side.scene.surroundings import Surroundings

_RESIDUAL = 1e-12  # of Bullet's constraint solver: its default lets a resting arm creep 3 mm a minute
_SPARE = 0.1  # m, more than meshes stand out of their capsules
_DOWN = -0.999  # height of the tool's z axis at home, from which it points down


class ArmWorld:
    """The arm and its obstacles in a world of PyBullet of their own, the arm at the scenario's start.

    Args:
        scenario: start, joints, and the obstacles that the start must be clear of.

    Raises ScenarioError when the arm cannot reach start or targets, or would stand in a collision at the start.
    """

    def __init__(self, scenario: RobotScenario) -> None:
        try:
            self.arm = chosen_arm(scenario.robot)
        except ScenarioError as error:
            raise ScenarioError(f"scenario {scenario.name}: {error}") from None
        self.kinematics = Kinematics(self.arm)
        self._q = _start_configuration(self.kinematics, scenario)
        _check_targets(self.kinematics, self._q, scenario)
        self._bullet, self._client = connect()
        try:
            self._load_arm()
            self._obstacles = BulletObstacles(self._bullet, self._client, self.body, min(self.joint_indices))
            self._check_start(scenario)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Disconnect from the physics engine."""
        if self._client >= 0:
            self._bullet.disconnect(physicsClientId=self._client)
            self._client = -1

    def _load_arm(self) -> None:
        bullet, client = self._bullet, self._client
        bullet.setPhysicsEngineParameter(solverResidualThreshold=_RESIDUAL, physicsClientId=client)
        flags = bullet.URDF_USE_INERTIA_FROM_FILE | bullet.URDF_USE_SELF_COLLISION
        with tempfile.TemporaryDirectory() as folder, quiet():
            path = Path(folder) / "arm.urdf"
            path.write_text(self.arm.urdf, encoding="utf-8")
            self.body = bullet.loadURDF(str(path), useFixedBase=True, flags=flags, physicsClientId=client)
        self.link_indices: dict[str, int] = {}
        joints: dict[str, int] = {}
        for index in range(bullet.getNumJoints(self.body, physicsClientId=client)):
            info = bullet.getJointInfo(self.body, index, physicsClientId=client)
            joints[info[1].decode()] = index
            self.link_indices[info[12].decode()] = index
        self.joint_indices = [joints[name] for name in self.arm.joint_names]
        for index, angle in zip(self.joint_indices, self._q, strict=True):
            bullet.resetJointState(self.body, index, angle, physicsClientId=client)
        self._colliding_pairs: list[tuple[str, str]] = []
        for one, other in combinations(self.link_indices, 2):
            if frozenset((one, other)) not in self.arm.never_colliding:
                self._colliding_pairs.append((one, other))
                continue
            a, b = self.link_indices[one], self.link_indices[other]
            bullet.setCollisionFilterPair(self.body, self.body, a, b, 0, physicsClientId=client)

    def _check_start(self, scenario: RobotScenario) -> None:
        bullet, client = self._bullet, self._client
        bullet.performCollisionDetection(physicsClientId=client)
        for one, other in self._colliding_pairs:
            a, b = self.link_indices[one], self.link_indices[other]
            if bullet.getClosestPoints(self.body, self.body, 0.0, a, b, physicsClientId=client):
                raise ScenarioError(
                    f"scenario {scenario.name}: start: {one} and {other} of the {self.arm.title} touch there; "
                    "choose another start, or other robot.joints to start the search from"
                )
        nearest = self._obstacles.nearest(scenario.obstacles)
        if nearest is not None and nearest[0] <= 0.0:
            raise ScenarioError(
                f"scenario {scenario.name}: start: the {self.arm.title}'s arm reaches {-nearest[0]:.3f} m into "
                f"obstacle {nearest[1]!r} there; move the obstacle or the start"
            )
        if scenario.guard.on:
            check_arm_clear(scenario, self.arm, self._q)


class ArmRobot(ArmWorld, Robot):
    """Follows twists of its tool, which points as at home and is kept as it was turned last.

    Args:
        scenario: start, joints, velocity control, and the obstacles that the start must be clear of.

    Raises ScenarioError when the arm cannot reach start or targets, or would stand in a collision at the start.
    """

    catches_up = True
    guards_itself = True

    def __init__(self, scenario: RobotScenario) -> None:
        super().__init__(scenario)
        arm = self.arm
        self.joint_names, self.model = arm.joint_names, arm.name
        self.control, self._guard = _controls(self, scenario)
        self._chain = ArmChain(arm)
        self._keeps_direction = scenario.robot.velocity_control == "direction"
        self._commanded: Array = np.zeros(arm.n)
        # Positions and velocities of the joints, written together and in place: this happens in every period.
        joints: Array = np.zeros(2 * arm.n)
        self._q, self._qd, self._joints = joints[: arm.n], joints[arm.n :], joints.data
        self._write = Struct(f"{2 * arm.n}d").pack_into
        self._twist, self._wanted, self._omega = STILL, np.zeros(3), np.zeros(3)
        # the joints' frames where the arm's clearance was measured last
        self._R_then, self._p_then = np.zeros((arm.n, 3, 3)), np.full((arm.n, 3), np.inf)
        self._reach = _reach(arm)
        self._forces = arm.max_torque.tolist()
        self._dt = 0.0
        self._read()
        self._moved()

    @classmethod
    def for_scenario(cls, scenario: RobotScenario) -> "ArmRobot":
        """See Robot."""
        return cls(scenario)

    @classmethod
    def check_start(cls, scenario: RobotScenario) -> None:
        """See Robot; compiles what a period needs."""
        world = ArmWorld(scenario)
        world.close()
        _controls(world, scenario)

    @classmethod
    def prepare(cls, scenario: RobotScenario) -> None:
        """See Robot."""
        if scenario.guard.on:
            ArmGuard(chosen_arm(scenario.robot), scenario.guard, 0.0, 1.0 / scenario.robot.rate_hz)

    def sample(self) -> RobotSample:
        """The state now."""
        px, py, pz, vx, vy, vz, a, b, c, d, wx, wy, wz = self._chain.state.tolist()
        return RobotSample((px, py, pz), (vx, vy, vz), (a, b, c, d), self._positions, (wx, wy, wz))

    def step(self, twist: Twist, dt: float, surroundings: Surroundings | None = None) -> None:
        """One period of `dt` s under the commanded twist."""
        bullet, client = self._bullet, self._client
        if dt != self._dt:
            self._dt = dt
            bullet.setTimeStep(dt, physicsClientId=client)
        if twist != self._twist:
            self._ask(twist)
        if surroundings is None or self._guard is None:
            self._drive(self._by_law(dt))
            return
        asked = None if self._keeps_direction else self._by_law(dt)
        joints = Joints(self._q, self._qd, self._commanded)
        R_base_wanted = self.control.R_base_wanted
        self._drive(
            self._guard.command(
                joints, self._wanted, self._omega, R_base_wanted, surroundings, asked, self._chain
            )
        )

    def _ask(self, twist: Twist) -> None:
        self._twist, self._wanted, self._omega = twist, np.array(twist.linear), np.array(twist.angular)

    def _by_law(self, dt: float) -> Array:
        return self.control.joint_velocity(
            self._q, self._commanded, self._tool, self._wanted, dt, self._omega
        )

    def halt(self, dt: float) -> None:
        """Brake all joints together, on the way that the guard has found clear."""
        if self._guard is None:
            super().halt(dt)
        else:
            self._ask(STILL)
            self._drive(self._guard.halt(self._commanded))

    def intervention(self) -> Intervention | None:
        """See Robot."""
        return None if self._guard is None else self._guard.did

    def _drive(self, commanded: Array) -> None:
        """One period of physics under joint velocities (n,), rad/s."""
        bullet, client = self._bullet, self._client
        self._commanded = commanded
        if self.arm.holds_itself:
            bullet.setJointMotorControlArray(
                self.body,
                self.joint_indices,
                bullet.TORQUE_CONTROL,
                forces=self.kinematics.gravity(self._q).tolist(),
                physicsClientId=client,
            )
        bullet.setJointMotorControlArray(
            self.body,
            self.joint_indices,
            bullet.VELOCITY_CONTROL,
            targetVelocities=self._commanded.tolist(),
            forces=self._forces,
            physicsClientId=client,
        )
        bullet.stepSimulation(client)
        self._read()

    def arm_clearance(self, obstacles: Sequence[Obstacle]) -> float | None:
        """Distance of the whole arm to the nearest obstacle (m), 1 to 3 mm short of the truth."""
        nearest = self._nearest(obstacles)
        return None if nearest is None else nearest[0]

    def _nearest(self, obstacles: Sequence[Obstacle]) -> tuple[float, str, int] | None:
        return self._obstacles.nearest(obstacles, self._moved())

    def _moved(self) -> float:
        """How far any point of the arm can have gone since this was asked last (m)."""
        now = self._chain
        moved: float = moved_at_most(
            now.R_base_joint, now.p_base_joint, self._R_then, self._p_then, self._reach
        )
        return moved

    def held_by(self) -> str:
        """See Robot."""
        return holder(self.kinematics, self._q, self._tool.jacobian, self._commanded, self._wanted)

    def nearest_part(self, obstacles: Sequence[Obstacle]) -> tuple[str, str]:
        """See Robot."""
        nearest = self._nearest(obstacles)
        if nearest is None:
            return "", ""
        names = {number: name for name, number in self.link_indices.items()}
        return names.get(nearest[2], "base"), nearest[1]

    def _read(self) -> None:
        states = self._bullet.getJointStates(self.body, self.joint_indices, self._client)
        self._positions, velocities, _, _ = zip(*states, strict=True)
        self._write(self._joints, 0, *self._positions, *velocities)
        self._tool = self._chain.at(self._q, self._qd)


def _controls(world: ArmWorld, scenario: RobotScenario) -> tuple[VelocityControl, ArmGuard | None]:
    """The velocity control and the guard that a scenario asks for."""
    arm, settings, down = world.arm, scenario.robot, world.kinematics.R_base_tool_down
    bounds = JointBounds(arm.lower, arm.upper, arm.max_velocity, arm.max_acceleration)
    control: VelocityControl = (
        DirectionKeeping(bounds, down, arm.home)
        if settings.velocity_control == "direction"
        else DampedLeastSquares(bounds, arm.max_velocity, down)
    )
    guard = ArmGuard(arm, scenario.guard, settings.lag, 1.0 / settings.rate_hz) if scenario.guard.on else None
    prepare_holder(arm.n)
    return control, guard


def _reach(arm: ArmModel) -> float:
    """No point of a link is farther than this from the frame of the joint that moves it (m)."""
    ends = [float(np.linalg.norm(end)) + each.radius for each in arm.capsules for end in (each.a, each.b)]
    return max(ends, default=0.0) + _SPARE


def _start_configuration(kinematics: Kinematics, scenario: RobotScenario) -> Array:
    joints = scenario.robot.joints
    q = kinematics.inverse_tool_down(scenario.start, None if joints is None else np.array(joints))
    if q is None:
        raise _unreachable("start", scenario.start, kinematics, scenario)
    return q


def _check_targets(kinematics: Kinematics, q: Array, scenario: RobotScenario) -> None:
    for index, target in enumerate(scenario.targets):
        if kinematics.inverse_tool_down(target, q) is None:
            raise _unreachable(f"targets[{index}]", target, kinematics, scenario)


def _unreachable(key: str, place: Vector3, kinematics: Kinematics, scenario: RobotScenario) -> ScenarioError:
    arm, (x, y, z) = kinematics.arm, place
    pointing = "down" if float(kinematics.R_base_tool_down[2, 2]) < _DOWN else "as at home"
    reach = f"; {arm.reach}" if arm.reach else ""
    return ScenarioError(
        f"scenario {scenario.name}: {key}: unreachable by the {arm.title} with the tool {pointing}: "
        f"({x:g}, {y:g}, {z:g}) m{reach}"
    )
