"""The settings of the robot, and what the robot's side reads of a scenario."""

from typing import Annotated, Literal, Protocol

from msgspec import Meta, Struct

from farhand.common.messages.base import ZERO, NonNegative, Positive, Real, Vector3
from farhand.common.messages.scene import Obstacle
from farhand.common.scenario.section import KindSection, Rate
from farhand.robot_side.arm.catalogue import ARMS, SHAPELESS, unknown_arm
from farhand.robot_side.safety.guard.settings import GuardSettings
from farhand.robot_side.safety.settings import SafetySettings

Joints = Annotated[tuple[Real, ...], Meta(min_length=1, max_length=16)]
File = Annotated[str, Meta(min_length=1, max_length=4096)]


FILES = ("urdf", "srdf", "capsules")
"""Settings that name a file."""
_NO_ARMS = ("box", "point")


def wrong_length(key: str, given: int, title: str, joints: int) -> str:
    """What is said of joint positions that are too many or too few."""
    return f"{key}: the {title} has {joints} joints, not {given}"


class ToolSettings(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What is on the arm and must stay clear as well: a capsule, or a sphere where both ends are the same.

    Attributes:
        radius: in m.
        start, end: of the capsule's segment, in the tool's frame (m).
    """

    radius: Positive
    start: Vector3 = ZERO
    end: Vector3 = ZERO


class RobotSettings(KindSection, frozen=True, kw_only=True):
    """The robot and its loops; what a kind from outside alone needs is in the table named after it.

    Attributes:
        kind: which robot: `arm` (PyBullet; which one say `model` or `urdf`), `ur5` (the arm of that model), `ur` (a
            real UR arm), `box` (PyBullet free-flying box), `point` (first-order lag, fast), or one that an installed
            package brings.
        model: an arm that is known by name: ur3, ur5, ur10, ur3e, ur5e, panda.
        host: address of the controller, for kind `ur`.
        urdf: the file of any other arm: six or seven revolute joints in a row.
        srdf: what says which of its links never collide; without it all but neighbours are kept apart.
        capsules: what `farhand arm fit` wrote of it; without it the capsules are fitted at the start.
        tool_frame: link of the URDF whose frame is steered.
        home: configuration in which the tool points as it shall (rad).
        tool: what the arm holds.
        radius: of the sphere around the tool that must stay clear (m).
        rate_hz: control and simulation rate.
        state_rate_hz: rate of RobotState messages.
        lag: time constant with which the tool follows a velocity command (s); for `point` it is the model,
            for the others what the operator's side shall compensate.
        joints: start configuration (rad); the inverse kinematics' seed when the start is elsewhere.
        velocity_control: `direction` (QP that keeps the direction) or `damped` (damped least squares).
        max_joint_acceleration: of every joint, where the arm's own is not lower (rad/s^2).
    """

    kind: str = "ur5"
    radius: NonNegative = 0.05
    rate_hz: Rate = 500.0
    state_rate_hz: Rate = 100.0
    lag: Annotated[float, Meta(ge=0, le=2)] = 0.016
    model: File | None = None
    host: File | None = None
    urdf: File | None = None
    srdf: File | None = None
    capsules: File | None = None
    tool_frame: File | None = None
    home: Joints | None = None
    tool: ToolSettings | None = None
    joints: Joints | None = None
    velocity_control: Literal["direction", "damped"] = "direction"
    max_joint_acceleration: Positive = 15.0

    def __post_init__(self) -> None:
        """Raise ValueError where an arm is not named, named twice or not known."""
        if self.kind in _NO_ARMS and self.tool is not None:
            raise ValueError(f"tool: is for an arm, not for kind {self.kind!r}")
        if self.kind == "ur5" and (self.urdf is not None or self.model not in (None, "ur5")):
            raise ValueError("kind 'ur5' is the arm of that name; for another set kind = 'arm'")
        if self.kind == "arm" and self.model is not None and self.urdf is not None:
            raise ValueError("model and urdf name two arms; give one of them")
        if self.kind == "arm" and self.model is None and self.urdf is None:
            raise ValueError(f"kind 'arm' needs model, one of {', '.join(ARMS)}, or urdf, a file")
        if self.kind == "ur":
            self._check_real()
        if self.kind in ("arm", "ur5", "ur"):
            self._check_known()

    @property
    def known_model(self) -> str:
        """Name of the known arm that it is; empty: one from a file, or none."""
        return "ur5" if self.kind == "ur5" else (self.model or "")

    def _check_real(self) -> None:
        if self.host is None:
            raise ValueError("kind 'ur' needs host, the address of the arm's controller")
        real = [name for name in ARMS if name.startswith("ur")]
        if (self.model is None) == (self.urdf is None):
            raise ValueError(
                f"kind 'ur' needs model, one of {', '.join(real)}, or urdf, the file of any other UR arm"
            )
        if self.model in ARMS and self.model not in real:
            raise ValueError(f"model {self.model!r} is no UR arm; there are {', '.join(real)}")

    def _check_known(self) -> None:
        name = self.known_model
        if not name:
            return
        if name not in ARMS:
            others = "" if name.lower() in SHAPELESS else "; any other by its urdf"
            raise ValueError(f"model {name!r}: {unknown_arm(name)}{others}")
        for key in ("srdf", "capsules", "tool_frame"):
            if getattr(self, key) is not None:
                raise ValueError(f"{key}: goes with urdf; the {ARMS[name].title}'s is known")
        for key in ("home", "joints"):
            given = getattr(self, key)
            if given is not None and len(given) != len(ARMS[name].home):
                raise ValueError(wrong_length(key, len(given), ARMS[name].title, len(ARMS[name].home)))


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

    @property
    def guard(self) -> GuardSettings:
        """What keeps the whole body clear."""
        ...
