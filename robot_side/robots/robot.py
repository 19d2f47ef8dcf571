"""The interface of every robot, and what it is sampled as."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar

import msgspec

from farhand.common.geometry import STILL, Twist
from farhand.common.messages.base import Quaternion, Vector3
from farhand.common.messages.intervention import Intervention
from farhand.common.messages.scene import Obstacle
from farhand.common.scenario.section import NoSettings, Section
from farhand.robot_side.robots.settings import RobotScenario
from farhand.robot_side.safety.guard.crowding import Crowding
from farhand.robot_side.scene.surroundings import Surroundings


class RobotSample(msgspec.Struct, frozen=True):
    """The tool in the base frame, and the joints.

    Attributes:
        position: of the tool (m).
        velocity: of the tool (m/s).
        orientation: of the tool, unit quaternion (w, x, y, z).
        joints: joint positions (rad); empty for robots without joints.
        angular_velocity: of the tool, about base's axes (rad/s).
    """

    position: Vector3
    velocity: Vector3
    orientation: Quaternion = (1.0, 0.0, 0.0, 0.0)
    joints: tuple[float, ...] = ()
    angular_velocity: Vector3 = (0.0, 0.0, 0.0)


class Robot(ABC):
    """A robot that follows twists of its tool, one control period at a time.

    One small file, and one line in registry.py or an entry point in `farhand.robots`.

    Attributes:
        Settings: the type of its own settings, read from the table `[robot.NAME]`.
        joint_names: of `RobotSample.joints`, in its order; empty for robots without joints.
        model: name of the model, for those who draw it; empty where there is none.
        catches_up: whether periods that a late loop missed are stepped one by one afterwards. Right for a
            simulator, whose time would fall behind; for hardware, whose time went on, it would be a burst.
        guards_itself: whether `step` keeps its whole body clear of `surroundings`; of others the robot's program
            guards the sphere around the tool.
        is_real: whether it is hardware, or stands for it; virtual time cannot drive it.
        rate_hz: of its own controller; None: it is stepped as often as the scenario says.
        notes: lines for people on what was found at its start.
        sample_age: how old it was what `sample` said last (s): more than 0 where a controller has fallen silent.
    """

    Settings: ClassVar[type[Section]] = NoSettings
    joint_names: tuple[str, ...] = ()
    model: str = ""
    catches_up: bool = False
    guards_itself: bool = False
    is_real: bool = False
    rate_hz: float | None = None
    notes: Sequence[str] = ()
    sample_age: float = 0.0

    @classmethod
    @abstractmethod
    def for_scenario(cls, scenario: RobotScenario) -> "Robot":
        """The robot at the scenario's start; raises ScenarioError when it cannot stand there."""

    @classmethod  # noqa: B027 (some can tell only by being there)
    def check_start(cls, scenario: RobotScenario) -> None:
        """Raise ScenarioError when the robot cannot stand at the scenario's start; connects to nothing."""

    @classmethod  # noqa: B027 (most have nothing to prepare)
    def prepare(cls, scenario: RobotScenario) -> None:
        """Compile what it needs, so that no control period waits for it; connects to nothing."""

    @abstractmethod
    def sample(self) -> RobotSample:
        """The state now."""

    @abstractmethod
    def step(self, twist: Twist, dt: float, surroundings: Surroundings | None = None) -> None:
        """One period of `dt` s under the commanded twist of the tool.

        Args:
            twist: velocity of the tool and how it turns, both in base. A robot that cannot turn leaves `angular`.
            dt: (s).
            surroundings: what a robot with a guard of its own keeps clear of in this period; None: no guard.
        """

    def halt(self, dt: float) -> None:
        """One period of `dt` s of a latched stop: brake, and step aside from nothing."""
        self.step(STILL, dt)

    def rest(self) -> None:
        """The tool is to stay turned as it is: nothing is turned back to what was commanded before."""
        return None

    def intervention(self) -> Intervention | None:
        """What its own guard did in the last period; None: nothing, or it has none."""
        return None

    def arm_clearance(self, obstacles: Sequence[Obstacle]) -> float | None:
        """Distance of the whole body to the nearest obstacle (m); None where it is not computed."""
        return None

    def nearest_part(self, obstacles: Sequence[Obstacle]) -> tuple[str, str]:
        """The part of the body that is nearest to an obstacle, and that obstacle; empty where not computed."""
        return "", ""

    def crowded(self, around: Surroundings) -> Crowding | None:
        """What of `around` its own guard could not keep off its body from now on; None: nothing, or it has no guard."""
        return None

    def held_by(self) -> str:
        """What keeps it from following its last command, such as `joint limit: elbow`; empty: nothing does."""
        return ""

    def stopped_by(self) -> str:
        """What keeps it from moving at all now, and what to do, such as `protective stop: ...`; empty: nothing does.

        It is asked in every period, after `sample`. While it says something the robot is stopped, and it moves again
        only by an acknowledgement that is newer.
        """
        return ""

    def close(self) -> None:  # noqa: B027 (some have nothing to give back)
        """Give everything back; the robot is of no use afterwards."""
