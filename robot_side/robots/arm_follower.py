"""What every arm does with a twist of its tool, whatever drives its joints: guard, velocity control, what it says."""

from collections.abc import Sequence
from struct import Struct

import numpy as np

from farhand.common.geometry import STILL, Array, Twist
from farhand.common.messages.intervention import Intervention
from farhand.robot_side.arm.chain import ArmChain
from farhand.robot_side.arm.holder import holder
from farhand.robot_side.arm.holder import prepare as prepare_holder
from farhand.robot_side.arm.kinematics import Kinematics
from farhand.robot_side.arm.limits import JointBounds
from farhand.robot_side.arm.velocity_control import DampedLeastSquares, DirectionKeeping, VelocityControl
from farhand.robot_side.robots.robot import RobotSample
from farhand.robot_side.robots.settings import RobotScenario
from farhand.robot_side.safety.guard.arm_guard import ArmGuard, Joints
from farhand.robot_side.safety.guard.crowding import Crowding
from farhand.robot_side.scene.surroundings import Surroundings


class ArmFollower:
    """From twists to joint velocities. It drives nothing: whoever does tells it where the joints are.

    Args:
        kinematics: of the arm.
        scenario: velocity control, guard, rate.
        q: (n,) where the joints are (rad).
        chain: the arm's kinematics, to be shared with others who only look; None: one of its own.

    Attributes:
        control: the velocity control.
        commanded: (n,) joint velocities asked for last (rad/s).
        q, qd: (n,) where the joints are, and how fast (rad, rad/s); filled anew by each `observe`.
    """

    def __init__(
        self, kinematics: Kinematics, scenario: RobotScenario, q: Array, chain: ArmChain | None = None
    ) -> None:
        self._kinematics = kinematics
        arm = kinematics.arm
        self.control, self.guard = controls(kinematics, scenario)
        self._chain = ArmChain(arm) if chain is None else chain
        self._keeps_direction = scenario.robot.velocity_control == "direction"
        self.commanded: Array = np.zeros(arm.n)
        self._twist, self._wanted, self._omega = STILL, np.zeros(3), np.zeros(3)
        # Positions and velocities of the joints, written together and in place: this happens in every period.
        self.q, self.qd, self._joints = self._chain.q, self._chain.qd, self._chain.joints.data
        self._tool = self._chain.tool
        self._write = Struct(f"{2 * arm.n}d").pack_into
        self._positions: tuple[float, ...] = ()
        self.observe(q.tolist(), [0.0] * arm.n)

    def observe(self, q: Sequence[float], qd: Sequence[float]) -> None:
        """The joints are here, and this fast (n each; rad, rad/s)."""
        self._positions = tuple(q)
        self._write(self._joints, 0, *q, *qd)
        self._chain.refresh()

    def sample(self) -> RobotSample:
        """The state that was observed last."""
        px, py, pz, vx, vy, vz, a, b, c, d, wx, wy, wz = self._chain.state.tolist()
        return RobotSample((px, py, pz), (vx, vy, vz), (a, b, c, d), self._positions, (wx, wy, wz))

    def follow(self, twist: Twist, dt: float, around: Surroundings | None) -> Array:
        """Joint velocities (n,), rad/s, for a period of `dt` s under a twist; `around` None: no guard."""
        if twist is not self._twist and twist != self._twist:
            self._ask(twist)
        if around is None or self.guard is None:
            self.commanded = self._by_law(dt)
            return self.commanded
        asked = None if self._keeps_direction else self._by_law(dt)
        joints = Joints(self.q, self.qd, self.commanded)
        R_base_wanted = self.control.R_base_wanted
        self.commanded = self.guard.command(
            joints, self._wanted, self._omega, R_base_wanted, around, asked, self._chain
        )
        return self.commanded

    def brake(self, dt: float) -> Array:
        """Joint velocities (n,), rad/s, with which all joints brake together, on the way that was found clear."""
        if self.guard is None:
            return self.follow(STILL, dt, None)
        self._ask(STILL)
        self.commanded = self.guard.halt(self.commanded)
        return self.commanded

    def forget(self) -> None:
        """Nothing is commanded any more, whatever was; the tool stays turned as it is."""
        self.commanded = np.zeros(len(self.q))
        self._ask(STILL)
        self.rest()

    def rest(self) -> None:
        """See Robot."""
        self.control.R_base_wanted[:] = self._tool.R_base_tool

    def held_by(self) -> str:
        """See Robot."""
        return holder(self._kinematics, self.q, self._tool.jacobian, self.commanded, self._wanted)

    def crowded(self, around: Surroundings) -> Crowding | None:
        """See Robot."""
        return (
            None
            if self.guard is None
            else self.guard.crowded(Joints(self.q, self.qd, self.commanded), around)
        )

    def intervention(self) -> Intervention | None:
        """See Robot."""
        return None if self.guard is None else self.guard.did

    def _ask(self, twist: Twist) -> None:
        self._twist, self._wanted, self._omega = twist, np.array(twist.linear), np.array(twist.angular)

    def _by_law(self, dt: float) -> Array:
        return self.control.joint_velocity(self.q, self.commanded, self._tool, self._wanted, dt, self._omega)


def controls(kinematics: Kinematics, scenario: RobotScenario) -> tuple[VelocityControl, ArmGuard | None]:
    """The velocity control and the guard that a scenario asks for."""
    arm, settings, down = kinematics.arm, scenario.robot, kinematics.R_base_tool_down
    bounds = JointBounds(arm.lower, arm.upper, arm.max_velocity, arm.max_acceleration)
    control: VelocityControl = (
        DirectionKeeping(bounds, down, arm.home)
        if settings.velocity_control == "direction"
        else DampedLeastSquares(bounds, arm.max_velocity, down)
    )
    guard = ArmGuard(arm, scenario.guard, settings.lag, 1.0 / settings.rate_hz) if scenario.guard.on else None
    prepare_holder(arm.n)
    return control, guard
