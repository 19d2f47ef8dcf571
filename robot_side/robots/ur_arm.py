"""A real UR arm: joint speeds to the program on its controller, its true state from there."""

from collections.abc import Sequence

import numpy as np

from farhand.common.errors import InputError
from farhand.common.geometry import Array, Twist
from farhand.common.messages.intervention import Intervention
from farhand.common.messages.scene import Obstacle
from farhand.common.scenario.section import own_settings
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.robot_side.arm.kinematics import Kinematics
from farhand.robot_side.robots.arm_follower import ArmFollower
from farhand.robot_side.robots.arms import chosen_arm
from farhand.robot_side.robots.pybullet_arm import ArmWorld
from farhand.robot_side.robots.robot import Robot, RobotSample
from farhand.robot_side.robots.settings import RobotScenario
from farhand.robot_side.robots.ur_start import at_its_rate, check_joints, first_facts, slower_arm
from farhand.robot_side.safety.guard.arm_guard import ArmGuard
from farhand.robot_side.safety.guard.crowding import Crowding
from farhand.robot_side.scene.surroundings import Surroundings
from farhand.robot_side.ur.attention import Attention
from farhand.robot_side.ur.deadline import measured_deadline
from farhand.robot_side.ur.link import UrLink
from farhand.robot_side.ur.settings import UrSettings, address_of
from farhand.robot_side.ur.states import STALE, Facts, again, slowed, unready

BRAKING_AT_THE_END = 0.5
"""s that an arm may take to brake when Farhand ends."""
STANDS = 1e-3
"""rad/s."""


class UrRobot(Robot):
    """Follows twists of its tool by the same guard and velocity control as an arm in the simulation.

    Args:
        scenario: host, model, guard, velocity control.
        link: to the controller, connected.
        facts: what was first known.
        clock: by which the link has been polled so far.

    Raises ScenarioError where it must not be driven from where it stands.
    """

    Settings = UrSettings
    guards_itself = True
    is_real = True

    def __init__(self, scenario: RobotScenario, link: UrLink, facts: Facts, clock: SystemClock) -> None:
        self._clock = clock
        self._link, self._facts = link, facts
        own: UrSettings = own_settings(scenario.robot, UrRobot, "robot")
        self.rate_hz = link.client.rate_hz
        scenario = at_its_rate(scenario, self.rate_hz)
        q = np.array(facts.values["actual_q"])
        check_joints(scenario, q)
        self._world = ArmWorld(scenario, q)
        arm = slower_arm(self._world.arm, own, 1.0 / self.rate_hz)
        self._follower = ArmFollower(Kinematics(arm), scenario, q)
        self._follower.forget()
        self.joint_names, self.model = arm.joint_names, arm.name
        self._attention = Attention(own)
        self._ready = False
        self._was = ""  # what stopped it, since it could be driven last

    @classmethod
    def for_scenario(cls, scenario: RobotScenario) -> "UrRobot":
        """Connect, look, measure the deadline while the arm stands. Raises InputError where it must not be driven."""
        own: UrSettings = own_settings(scenario.robot, cls, "robot")
        host = scenario.robot.host or ""
        acceleration = float(chosen_arm(scenario.robot).max_acceleration.max())
        link = UrLink(address_of(host), own, acceleration)
        clock = SystemClock()
        try:
            facts = first_facts(scenario, link, own, clock)
            robot = cls(scenario, link, facts, clock)
            deadline = measured_deadline(link, own, clock)
            if not deadline.kept:
                raise InputError(f"robot.host {host}: the deadline is not kept: {deadline.said}; not driven")
            robot.notes = (*link.notes(), f"deadline: {deadline.said}")
        except BaseException:
            link.close()
            raise
        return robot

    @classmethod
    def check_start(cls, scenario: RobotScenario) -> None:
        """See Robot; where it stands only its controller knows."""

    @classmethod
    def prepare(cls, scenario: RobotScenario) -> None:
        """See Robot."""
        if scenario.guard.on:
            ArmGuard(chosen_arm(scenario.robot), scenario.guard, 0.0, 1.0 / scenario.robot.rate_hz)

    def sample(self) -> RobotSample:
        """The newest state that the controller has sent."""
        facts = self._facts = self._link.poll(self._clock.now_ns())
        values = facts.values
        self.sample_age = facts.age if facts.age > STALE else 0.0
        self._follower.observe(values["actual_q"], values["actual_qd"])
        return self._follower.sample()

    def stopped_by(self) -> str:
        """See Robot."""
        why = unready(self._facts)
        self._ready = not why
        if why:
            self._follower.forget()
            self._was = self._was or why
            return why
        was, self._was = self._was, ""
        return self._attention.calls(self._facts.values) or again(was)

    def step(self, twist: Twist, dt: float, surroundings: Surroundings | None = None) -> None:
        """One period of `dt` s under the commanded twist."""
        if self._ready:
            self._send(self._follower.follow(twist, dt, surroundings))
        else:
            self._stand()

    def halt(self, dt: float) -> None:
        """Brake all joints together; once they stand, what was asked for before is forgotten."""
        if not self._ready:
            self._stand()
            return
        qd = self._follower.brake(dt)
        if not np.any(np.abs(qd) > STANDS):
            self._follower.forget()
        self._send(self._follower.commanded)

    def rest(self) -> None:
        """See Robot."""
        self._follower.rest()

    def intervention(self) -> Intervention | None:
        """See Robot."""
        return self._follower.intervention()

    def arm_clearance(self, obstacles: Sequence[Obstacle]) -> float | None:
        """See Robot."""
        self._world.place(self._follower.q)
        return self._world.clearance(obstacles)

    def nearest_part(self, obstacles: Sequence[Obstacle]) -> tuple[str, str]:
        """See Robot."""
        return self._world.nearest_names(obstacles)

    def crowded(self, around: Surroundings) -> Crowding | None:
        """See Robot."""
        return self._follower.crowded(around)

    def held_by(self) -> str:
        """See Robot."""
        return slowed(self._facts.values) or self._follower.held_by()

    def close(self) -> None:
        """Brake, end the program, hang up."""
        try:
            self._brake_to_a_stand()
            self._link.end_program()
        finally:
            self._link.close()
            self._world.close()

    def _stand(self) -> None:
        self._follower.forget()
        self._send(self._follower.commanded)

    def _send(self, qd: Array) -> None:
        self._link.send(qd.tolist(), self._clock.now_ns())

    def _brake_to_a_stand(self) -> None:
        assert self.rate_hz is not None
        dt, clock = 1.0 / self.rate_hz, self._clock
        next_ns = clock.now_ns()
        for _ in range(round(BRAKING_AT_THE_END * self.rate_hz)):
            if not self._ready or not np.any(self._follower.commanded):
                return
            self.sample()
            self.stopped_by()
            self.halt(dt)
            next_ns += to_ns(dt)
            clock.sleep_until(next_ns)
