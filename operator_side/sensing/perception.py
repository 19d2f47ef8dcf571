"""What the operator's side knows of the robot: newest state, scene and description, and what was refused."""

from collections import deque

from farhand.common.link.link import Packet
from farhand.common.messages.codec import Decoder
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.echo import LEFT_NS, Newest
from farhand.common.messages.intervention import Intervention
from farhand.common.messages.keys import description_key, scene_key, state_key
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.common.messages.twins import Twins

RATE_WINDOW = 50


class Perception:
    """Decodes what arrives and keeps the newest by sequence number.

    Args:
        robot: the robot's name.
    """

    def __init__(self, robot: str) -> None:
        self._state_key, self._scene_key = state_key(robot), scene_key(robot)
        self._description_key = description_key(robot)
        self._states, self._scenes = Decoder(RobotState), Decoder(Scene)
        self._descriptions = Decoder(RobotDescription)
        self.newest_state, self.newest_scene, self.newest_description = (Newest(LEFT_NS) for _ in range(3))
        self.state: RobotState | None = None
        self.scene: Scene | None = None
        self.description: RobotDescription | None = None
        self.states = 0
        self._guard: Intervention | None = None
        self._twins = Twins(LEFT_NS)
        self._arrivals: deque[int] = deque(maxlen=RATE_WINDOW)

    def take(self, packet: Packet) -> RobotState | None:
        """Take one packet; returns a state if it held one, new or late."""
        if packet.key == self._state_key:
            state = self._states.decode(packet.payload)
            if state is not None:
                self.states += 1
                self._arrivals.append(packet.arrived_ns)
                self._twins.note(state.session, packet.arrived_ns)
                if self.newest_state.accept(state, packet.arrived_ns):
                    self.state = state
                    self._guard = state.guard or self._guard
                    if state.mode in ("stopped", "estop") and not state.evades:
                        self._guard = None  # it moves nothing any more
            return state
        if packet.key == self._scene_key:
            scene = self._scenes.decode(packet.payload)
            if scene is not None and self.newest_scene.accept(scene, packet.arrived_ns):
                self.scene = scene
        if packet.key == self._description_key:
            description = self._descriptions.decode(packet.payload)
            if description is not None and self.newest_description.accept(description, packet.arrived_ns):
                self.description = description
        return None

    def take_guard(self) -> Intervention | None:
        """What the guard on the robot did since this was asked last, the newest; None: nothing."""
        did, self._guard = self._guard, None
        return did

    @property
    def lacking(self) -> str:
        """What has not come from the robot yet and must before anything moves; empty if all is there."""
        if self.state is None:
            return "state"
        if self.scene is None:
            return "scene"
        return "description" if self.description is None else ""

    def twins(self, now_ns: int) -> bool:
        """Whether two robots of this name send states."""
        return self._twins.there(now_ns)

    @property
    def refused(self) -> int:
        """Messages refused by the decoders."""
        return sum(d.refused.total() for d in (self._states, self._scenes, self._descriptions))

    def state_rate(self, now_ns: int) -> float:
        """States that arrived per second, over the last 50."""
        if len(self._arrivals) < 2 or now_ns <= self._arrivals[0]:
            return 0.0
        return len(self._arrivals) / ((now_ns - self._arrivals[0]) * 1e-9)
