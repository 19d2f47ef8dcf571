"""An arm in PyBullet: joint velocity motors with the arm's torque limits, inertias from the file."""

import tempfile
from collections.abc import Sequence
from itertools import combinations
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from farhand.common.errors import ScenarioError
from farhand.common.geometry import Array, Twist
from farhand.common.messages.intervention import Intervention
from farhand.common.messages.scene import Obstacle
from farhand.common.quantities import Vector3
from farhand.robot_side.arm.chain import ArmChain
from farhand.robot_side.arm.description.variants import first_link, massive_text
from farhand.robot_side.arm.kinematics import Kinematics
from farhand.robot_side.arm.model import ArmModel
from farhand.robot_side.kernel.body import moved_at_most
from farhand.robot_side.robots.arm_follower import ArmFollower, controls
from farhand.robot_side.robots.arms import chosen_arm
from farhand.robot_side.robots.bullet import connect, quiet
from farhand.robot_side.robots.bullet_obstacles import BulletObstacles
from farhand.robot_side.robots.robot import Robot, RobotSample
from farhand.robot_side.robots.settings import RobotScenario
from farhand.robot_side.safety.guard.arm_guard import ArmGuard
from farhand.robot_side.safety.guard.arm_start import check_arm_clear
from farhand.robot_side.safety.guard.crowding import Crowding
from farhand.robot_side.scene.surroundings import Surroundings

_RESIDUAL = 1e-12  # of Bullet's constraint solver: its default lets a resting arm creep 3 mm a minute
_SPARE = 0.1  # m, more than meshes stand out of their capsules
_DOWN = -0.999  # height of the tool's z axis at home, from which it points down


class ArmWorld:
    """The arm and its obstacles in a world of PyBullet of their own, the arm at the scenario's start.

    Args:
        scenario: start, joints, and the obstacles that the start must be clear of.
        q: (n,) where the arm stands instead (rad), as a real one does.

    Raises ScenarioError when the arm cannot reach start or targets, or would stand in a collision at the start.
    """

    def __init__(self, scenario: RobotScenario, q: Array | None = None) -> None:
        try:
            self.arm = chosen_arm(scenario.robot)
        except ScenarioError as error:
            raise ScenarioError(f"scenario {scenario.name}: {error}") from None
        self.kinematics = Kinematics(self.arm)
        self._q = _start_configuration(self.kinematics, scenario) if q is None else q
        self._stands_there = q is not None
        self._chain = ArmChain(self.arm)
        self._chain.at(self._q, np.zeros(self.arm.n))
        # what was found where the clearance was asked for last, and of which obstacles; None: which may have changed
        self._found: tuple[float, str, int] | None = None
        self._asked: tuple[Obstacle, ...] | None = None
        # the joints' frames where the arm's clearance was asked for last, and how far what is on them has moved since
        self._R_then, self._p_then = np.zeros((self.arm.n, 3, 3)), np.full((self.arm.n, 3), np.inf)
        self._reach = _reach(self.arm)
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

    def place(self, q: Array) -> None:
        """Put the arm at q (n,), rad, without any physics."""
        self._q = q
        self._chain.at(q, np.zeros(self.arm.n))
        for index, angle in zip(self.joint_indices, q.tolist(), strict=True):
            self._bullet.resetJointState(self.body, index, angle, physicsClientId=self._client)

    def clearance(self, obstacles: Sequence[Obstacle]) -> float | None:
        """Distance of the whole arm to the nearest obstacle (m), 1 to 3 mm short of the truth; None: none is near."""
        nearest = self._nearest(obstacles)
        return None if nearest is None else nearest[0]

    def nearest_names(self, obstacles: Sequence[Obstacle]) -> tuple[str, str]:
        """The link that is nearest to an obstacle, and that obstacle; empty: none is near."""
        nearest = self._nearest(obstacles)
        if nearest is None:
            return "", ""
        names = {number: name for name, number in self.link_indices.items()}
        return names.get(nearest[2], "base"), nearest[1]

    def _nearest(self, obstacles: Sequence[Obstacle]) -> tuple[float, str, int] | None:
        now = self._chain
        moved = moved_at_most(
            now.R_base_joint, now.p_base_joint, self._R_then, self._p_then, self._reach, self._carriers,
            self._moved,
        )  # fmt: skip
        if moved != 0.0 or obstacles is not self._asked:
            self._found = self._obstacles.nearest(obstacles, self._moved)
            self._asked = obstacles if isinstance(obstacles, tuple) else None
        return self._found

    def _load_arm(self) -> None:
        bullet, client = self._bullet, self._client
        bullet.setPhysicsEngineParameter(solverResidualThreshold=_RESIDUAL, physicsClientId=client)
        flags = bullet.URDF_USE_INERTIA_FROM_FILE | bullet.URDF_USE_SELF_COLLISION
        with tempfile.TemporaryDirectory() as folder, quiet():
            path = Path(folder) / "arm.urdf"
            path.write_text(massive_text(self.arm.urdf), encoding="utf-8")
            self.body = bullet.loadURDF(str(path), useFixedBase=True, flags=flags, physicsClientId=client)
        self.link_indices: dict[str, int] = {}
        base = bullet.getBodyInfo(self.body, physicsClientId=client)[0].decode()
        if base != first_link(self.arm.urdf):  # it stands in the place of a frame, and is one of the links
            self.link_indices[base] = -1
        joints: dict[str, int] = {}
        parents: list[int] = []
        for index in range(bullet.getNumJoints(self.body, physicsClientId=client)):
            info = bullet.getJointInfo(self.body, index, physicsClientId=client)
            joints[info[1].decode()] = index
            self.link_indices[info[12].decode()] = index
            parents.append(info[16])
        self.joint_indices = [joints[name] for name in self.arm.joint_names]
        self._carriers = _carriers(parents, self.joint_indices)
        self._moved: Array = np.zeros(len(self._carriers))
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
                way_out = "choose another start, or other robot.joints to start the search from"
                if self._stands_there:
                    way_out = "the arm stands so: move it at the pendant"
                raise ScenarioError(
                    f"scenario {scenario.name}: start: {one} and {other} of the {self.arm.title} touch there; {way_out}"
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
        self._follower = ArmFollower(self.kinematics, scenario, self._q, self._chain)
        self.control = self._follower.control
        self._q = self._follower.q
        self._forces = arm.max_torque.tolist()
        self._dt = 0.0
        self._read()

    @classmethod
    def for_scenario(cls, scenario: RobotScenario) -> "ArmRobot":
        """See Robot."""
        return cls(scenario)

    @classmethod
    def check_start(cls, scenario: RobotScenario) -> None:
        """See Robot; compiles what a period needs."""
        world = ArmWorld(scenario)
        world.close()
        controls(world.kinematics, scenario)

    @classmethod
    def prepare(cls, scenario: RobotScenario) -> None:
        """See Robot."""
        if scenario.guard.on:
            ArmGuard(chosen_arm(scenario.robot), scenario.guard, 0.0, 1.0 / scenario.robot.rate_hz)

    def sample(self) -> RobotSample:
        """The state now."""
        return self._follower.sample()

    def step(self, twist: Twist, dt: float, surroundings: Surroundings | None = None) -> None:
        """One period of `dt` s under the commanded twist."""
        if dt != self._dt:
            self._dt = dt
            self._bullet.setTimeStep(dt, physicsClientId=self._client)
        self._drive(self._follower.follow(twist, dt, surroundings))

    def halt(self, dt: float) -> None:
        """Brake all joints together, on the way that the guard has found clear."""
        if self._follower.guard is None:
            super().halt(dt)
        else:
            self._drive(self._follower.brake(dt))

    def rest(self) -> None:
        """See Robot."""
        self._follower.rest()

    def intervention(self) -> Intervention | None:
        """See Robot."""
        return self._follower.intervention()

    def _drive(self, commanded: Array) -> None:
        """One period of physics under joint velocities (n,), rad/s."""
        bullet, client = self._bullet, self._client
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
            targetVelocities=commanded.tolist(),
            forces=self._forces,
            physicsClientId=client,
        )
        bullet.stepSimulation(client)
        self._read()

    def arm_clearance(self, obstacles: Sequence[Obstacle]) -> float | None:
        """See Robot."""
        return self.clearance(obstacles)

    def crowded(self, around: Surroundings) -> Crowding | None:
        """See Robot."""
        return self._follower.crowded(around)

    def held_by(self) -> str:
        """See Robot."""
        return self._follower.held_by()

    def nearest_part(self, obstacles: Sequence[Obstacle]) -> tuple[str, str]:
        """See Robot."""
        return self.nearest_names(obstacles)

    def _read(self) -> None:
        states = self._bullet.getJointStates(self.body, self.joint_indices, self._client)
        positions, velocities, _, _ = zip(*states, strict=True)
        self._follower.observe(positions, velocities)


def _reach(arm: ArmModel) -> float:
    """No point of a link is farther than this from the frame of the joint that moves it (m)."""
    ends = [float(np.linalg.norm(end)) + each.radius for each in arm.capsules for end in (each.a, each.b)]
    return max(ends, default=0.0) + _SPARE


def _carriers(parents: Sequence[int], joint_indices: Sequence[int]) -> NDArray[np.int64]:
    """The number of the joint with which each link moves, from the first one that moves on.

    Args:
        parents: of each link, by its own index: the one it hangs on; -1: the base.
        joint_indices: (n,) the links that the joints move.
    """
    first, found = min(joint_indices), list[int]()
    for index in range(first, len(parents)):
        link = index
        while link not in joint_indices and link >= 0:
            link = parents[link]
        # one that hangs on the base stands: it has come no farther than any other
        found.append(joint_indices.index(link) if link >= 0 else 0)
    return np.array(found, np.int64)


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
