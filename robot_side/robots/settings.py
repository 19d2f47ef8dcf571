"""The settings of the robot, and what the robot's side reads of a scenario."""

from typing import Annotated, Literal, Protocol

from msgspec import Meta

from farhand.common.messages.base import NonNegative, Positive, Real, Vector3
from farhand.common.messages.scene import Obstacle
from farhand.common.scenario.section import KindSection, Rate
from farhand.robot_side.safety.settings import SafetySettings


class RobotSettings(KindSection, frozen=True, kw_only=True):
    """The robot and its loops; what a kind from outside alone needs is in the table named after it.

    Attributes:
        kind: which robot: `ur5` (PyBullet arm), `box` (PyBullet free-flying box), `point` (first-order lag,
            fast), or one that an installed package brings.
        radius: of the sphere around the tool that must stay clear (m).
        rate_hz: control and simulation rate.
        state_rate_hz: rate of RobotState messages.
        lag: time constant with which the tool follows a velocity command (s); for `point` it is the model,
            for the others what the operator's side shall compensate.
        joints: start configuration (rad); the inverse kinematics' seed when the start is elsewhere.
        velocity_control: `direction` (QP that keeps the direction) or `damped` (damped least squares).
        max_joint_acceleration: (rad/s^2).
    """

    kind: str = "ur5"
    radius: NonNegative = 0.05
    rate_hz: Rate = 500.0
    state_rate_hz: Rate = 100.0
    lag: Annotated[float, Meta(ge=0, le=2)] = 0.016
    joints: Annotated[tuple[Real, ...], Meta(min_length=6, max_length=6)] | None = None
    velocity_control: Literal["direction", "damped"] = "direction"
    max_joint_acceleration: Positive = 15.0


class RobotScenario(Protocol):
    """What the robot's side reads of a scenario."""

    @property
    def name(self) -> str:
        """Short name, for messages."""
        ...

    @property
    def start(self) -> Vector3:
        """Tool position at the start (m)."""
        ...

    @property
    def targets(self) -> tuple[Vector3, ...]:
        """To be reached in order (m)."""
        ...

    @property
    def obstacles(self) -> tuple[Obstacle, ...]:
        """As they are at the start."""
        ...

    @property
    def robot(self) -> RobotSettings:
        """The robot and its loops."""
        ...

    @property
    def safety(self) -> SafetySettings:
        """The watchdog."""
        ...
