"""What the operator's side knows of the robot: newest state and scene, and what was refused."""

from collections import deque

from farhand.common.link.link import Packet
from farhand.common.messages.codec import Decoder
from farhand.common.messages.echo import Newest
from farhand.common.messages.keys import scene_key, state_key
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState

RATE_WINDOW = 50


class Perception:
    """Decodes what arrives and keeps the newest by sequence number.

    Args:
        robot: the robot's name.
    """

    def __init__(self, robot: str) -> None:
        self._state_key, self._scene_key = state_key(robot), scene_key(robot)
        self._states, self._scenes = Decoder(RobotState), Decoder(Scene)
        self.newest_state, self.newest_scene = Newest(), Newest()
        self.state: RobotState | None = None
        self.scene: Scene | None = None
        self.states = 0
        self._arrivals: deque[int] = deque(maxlen=RATE_WINDOW)

    def take(self, packet: Packet) -> RobotState | None:
        """Take one packet; returns a state if it held one, new or late."""
        if packet.key == self._state_key:
            state = self._states.decode(packet.payload)
            if state is not None:
                self.states += 1
                self._arrivals.append(packet.arrived_ns)
                if self.newest_state.accept(state, packet.arrived_ns):
                    self.state = state
            return state
        if packet.key == self._scene_key:
            scene = self._scenes.decode(packet.payload)
            if scene is not None and self.newest_scene.accept(scene, packet.arrived_ns):
                self.scene = scene
        return None

    @property
    def refused(self) -> int:
        """Messages refused by the decoders."""
        return self._states.refused.total() + self._scenes.refused.total()

    def state_rate(self, now_ns: int) -> float:
        """States that arrived per second, over the last 50."""
        if len(self._arrivals) < 2 or now_ns <= self._arrivals[0]:
            return 0.0
        return len(self._arrivals) / ((now_ns - self._arrivals[0]) * 1e-9)
