"""The interface of everything that steers. Hold-to-run: motion only while the device is engaged."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar

from farhand.common.messages.base import Vector3
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.common.scenario.section import NoSettings, Section
from farhand.operator_side.steering.sides import Free, everything_is_free
from farhand.operator_side.steering.targets import Targets


@dataclass(frozen=True, slots=True)
class SteeringInput:
    """What the operator wants now.

    Attributes:
        velocity: desired tool velocity, base frame (m/s).
        angular: desired angular velocity of the tool, about base's axes (rad/s); zero holds its orientation.
        engaged: motion is allowed only while this holds.
        acknowledge: the operator has seen the robot's stop and clears it.
        estop: the operator wants the robot stopped for good.
        says: what the device has to say of a stop that it does not acknowledge; empty: nothing.
    """

    velocity: Vector3 = (0.0, 0.0, 0.0)
    engaged: bool = False
    acknowledge: bool = False
    estop: bool = False
    says: str = ""
    angular: Vector3 = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class View:
    """What a device may look at.

    Attributes:
        state: the robot's newest.
        scene: what is around it.
        targets: progress of the task, `targets.next` the one to reach now.
        now_ns: beginning of the tick.
        free: of several velocities (m/s), which the filter would let pass nearly as they are: `free([velocity])[0]`.
        driving: whether this operator holds control.
        stopping: whether an emergency stop that somebody asked this operator for is on its way: what was acknowledged
            before is out of date.
    """

    state: RobotState
    scene: Scene
    targets: Targets
    now_ns: int
    free: Free = everything_is_free
    driving: bool = True
    stopping: bool = False


class SteeringDevice(ABC):
    """A steering device. One small file, and one line in registry.py or an entry point in `farhand.devices`.

    Args:
        settings: the device's own, an instance of its `Settings`.

    Attributes:
        Settings: the type of its own settings, read from the table `[steering.NAME]`.
        acknowledges_itself: whether it clears latched stops without a person, which is said to people.
        rate_hz: at which it is read where nobody asks for another rate; None: at the scenario's. A hand feels 100 ms.
        ends_with_targets: whether the operator's program ends with the last target; a person decides that alone.
        over: whether it has nothing more to ask, ever: the program ends.
    """

    Settings: ClassVar[type[Section]] = NoSettings
    acknowledges_itself: ClassVar[bool] = False
    ends_with_targets: ClassVar[bool] = True
    over: bool = False
    rate_hz: ClassVar[float | None] = None

    def __init__(self, settings: Any = None) -> None:
        self.settings = settings

    @abstractmethod
    def read(self, view: View) -> SteeringInput:
        """What the operator wants now; called once a tick, must neither block nor raise."""
