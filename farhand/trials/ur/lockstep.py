"""A UR arm in virtual time: driver's control and emulated controller in lockstep, without sockets between them."""

import numpy as np

from farhand.common.errors import ScenarioError
from farhand.common.geometry import Twist
from farhand.robot_side.arm.kinematics import Kinematics
from farhand.robot_side.robots.arm_follower import ArmFollower
from farhand.robot_side.robots.arms import chosen_arm
from farhand.robot_side.robots.robot import Robot, RobotSample
from farhand.robot_side.robots.settings import RobotScenario
from farhand.robot_side.robots.ur_start import slower_arm
from farhand.robot_side.scene.surroundings import Surroundings
from farhand.robot_side.ur.program import INPUTS, message, program_text
from farhand.robot_side.ur.settings import UrSettings
from farhand.ur_emulator.controller import Controller
from farhand.ur_emulator.functions import WAITS, Functions
from farhand.ur_emulator.models import E_SERIES
from farhand.ur_emulator.program import Program
from farhand.ur_emulator.sockets import ProgramSockets
from farhand.ur_emulator.urscript import translate
from farhand.ur_emulator.wire import Wire

RUN = 1


class LockstepUr(Robot):
    """What UrRobot does with an arm that answers two cycles later; see there.

    Args:
        scenario: its arm is a UR.

    Attributes:
        asked: twist and surroundings of every period; None: it was to halt.
    """

    guards_itself = True

    def __init__(self, scenario: RobotScenario) -> None:
        arm, own = chosen_arm(scenario.robot), UrSettings()
        seed = scenario.robot.joints
        q = Kinematics(arm).inverse_tool_down(scenario.start, None if seed is None else np.array(seed))
        if q is None:
            raise ScenarioError(f"scenario {scenario.name}: the arm cannot reach its start")
        self.controller = Controller(arm, q, scenario.robot.rate_hz, E_SERIES, lambda line: None)
        step = self.controller.step_time
        self._follower = ArmFollower(Kinematics(slower_arm(arm, own, step)), scenario, q)
        self._follower.forget()
        self._own = own
        self.joint_names, self.model = arm.joint_names, arm.name
        functions = Functions(self.controller, ProgramSockets(Wire())).table()
        text = program_text(own, RUN, step, float(arm.max_acceleration.max()))
        self.controller.start_program(Program(translate(text, WAITS, functions), functions))
        self.asked: list[tuple[Twist, Surroundings | None] | None] = []
        self._number = 0
        self._next: list[float] = []

    @classmethod
    def for_scenario(cls, scenario: RobotScenario) -> "LockstepUr":
        """See Robot."""
        return cls(scenario)

    def sample(self) -> RobotSample:
        """See Robot."""
        physics = self.controller.physics
        self._follower.observe(physics.q.tolist(), physics.qd.tolist())
        return self._follower.sample()

    def step(self, twist: Twist, dt: float, surroundings: Surroundings | None = None) -> None:
        """See Robot."""
        self.asked.append((twist, surroundings))
        self._cycle(self._follower.follow(twist, dt, surroundings).tolist())

    def halt(self, dt: float) -> None:
        """See Robot."""
        self.asked.append(None)
        self._cycle(self._follower.brake(dt).tolist())

    def close(self) -> None:
        """See Robot."""
        self.controller.close()

    def _cycle(self, qd: list[float]) -> None:
        """What was told in the last period is obeyed in this one."""
        if self._next:
            self.controller.registers.inputs.update(zip(INPUTS, self._next, strict=True))
        self._number += 1
        self._next = message(self._number, self._own.deadline_time, RUN, qd)
        self.controller.cycle()
