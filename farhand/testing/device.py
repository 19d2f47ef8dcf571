"""A steering device that wants what a test says."""

from collections.abc import Sequence

from farhand.common.messages.base import Vector3
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.common.timing.clock import to_ns
from farhand.operator_side.steering.device import SteeringDevice, SteeringInput, View
from farhand.operator_side.steering.targets import Targets
from farhand.testing.messages import scene as make_scene
from farhand.testing.messages import state as make_state

TOLERANCE = 0.02


def view(now_ns: int = 0, state: RobotState | None = None, scene: Scene | None = None) -> View:
    """What a device is read with: a robot at the origin and a scene without targets, unless others are given.

    Args:
        now_ns: beginning of the tick.
        state, scene: what the device sees; progress through the scene's targets is that of the state's position.
    """
    state, scene = state or make_state(), scene or make_scene()
    targets = Targets(TOLERANCE)
    targets.update(state, scene)
    return View(state, scene, targets, now_ns)


class ScriptedDevice(SteeringDevice):
    """Wants `wants`, until the test assigns another wish or the script's next instant has come.

    Args:
        wants: at first; a bare velocity (m/s, base) is one with the device engaged.
        script: (seconds since the first reading, wish from then on), in order of time.

    Attributes:
        wants: assign to it at any time.
        looked: every view that it was read with.
    """

    def __init__(
        self,
        wants: SteeringInput | Vector3 = (0.2, 0.0, 0.0),
        script: Sequence[tuple[float, SteeringInput | Vector3]] = (),
    ) -> None:
        super().__init__()
        self.wants = wants
        self.looked: list[View] = []
        self._script = [(to_ns(seconds), wish) for seconds, wish in script]

    def read(self, view: View) -> SteeringInput:
        """The wish at the view's instant."""
        self.looked.append(view)
        since_ns = view.now_ns - self.looked[0].now_ns
        while self._script and self._script[0][0] <= since_ns:
            self.wants = self._script.pop(0)[1]
        return (
            self.wants if isinstance(self.wants, SteeringInput) else SteeringInput(self.wants, engaged=True)
        )
