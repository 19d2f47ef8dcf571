"""A steering device that wants what a test says."""

from collections.abc import Sequence

from farhand.common.messages.base import Vector3
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.common.timing.clock import to_ns
from farhand.operator_side.steering.device import SteeringInput


class ScriptedDevice:
    """Wants `wants`, until the test assigns another wish or the script's next instant has come.

    Args:
        wants: at first; a bare velocity (m/s, base) is one with the device engaged.
        script: (seconds since the first reading, wish from then on), in order of time.

    Attributes:
        wants: assign to it at any time.
        progress, finished: what the device says of its targets.
        looked: every (state, scene, now_ns) that it was read with.
    """

    def __init__(
        self,
        wants: SteeringInput | Vector3 = (0.2, 0.0, 0.0),
        script: Sequence[tuple[float, SteeringInput | Vector3]] = (),
    ) -> None:
        self.wants = wants
        self.finished = False
        self.progress = (0, 0)
        self.looked: list[tuple[RobotState, Scene, int]] = []
        self._script = [(to_ns(seconds), wish) for seconds, wish in script]

    def read(self, state: RobotState, scene: Scene, now_ns: int) -> SteeringInput:
        """The wish at `now_ns`."""
        self.looked.append((state, scene, now_ns))
        since_ns = now_ns - self.looked[0][2]
        while self._script and self._script[0][0] <= since_ns:
            self.wants = self._script.pop(0)[1]
        return (
            self.wants if isinstance(self.wants, SteeringInput) else SteeringInput(self.wants, engaged=True)
        )
