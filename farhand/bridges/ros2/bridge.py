"""The bridge put together: one node of the ROS graph, and a link to Farhand."""

from collections.abc import Callable
from typing import Protocol

from farhand.bridges.ros2.bridge_node import BridgeNode, Device
from farhand.bridges.ros2.cdr.twists import TWIST
from farhand.bridges.ros2.graph.node import RosNode
from farhand.bridges.ros2.graph.wire import SENSOR
from farhand.bridges.ros2.inbound.devices import JoyDevice, TwistDevice
from farhand.bridges.ros2.inbound.reading import JOY, Reader, Refusals, TwistFrames
from farhand.bridges.ros2.inbound.twist_hand import SILENCE_NS, TwistHand
from farhand.bridges.ros2.outbound.outward import Outward
from farhand.bridges.ros2.serving.parameters import Parameters, Value
from farhand.bridges.ros2.serving.services import Services
from farhand.bridges.ros2.settings import UNITS, Ros2Options
from farhand.common.link.link import Link
from farhand.common.timing.clock import SystemClock
from farhand.operator_side.steering.hand.sender import SteeringSender


class Desk(Protocol):
    """Who does what the services ask for."""

    def estop(self) -> tuple[bool, str]:
        """Stop the robot for good: whether it has, and words."""
        ...

    def acknowledge(self) -> tuple[bool, str]:
        """Clear its stop: whether it has, and words."""
        ...

    def kept(self) -> float | None:
        """The distance that is kept from obstacles, without the margin (m); None: nobody says."""
        ...


class Bridge:
    """Args:
    options: what is asked for.
    node: of the ROS graph.
    link: to Farhand.
    desk: does what the services ask for.
    clock: of this process.
    session: draws a session for a device.
    tell: takes a line for people; must not wait.

    Attributes:
        node: to be run in a loop.
        refusals: what counted for nothing.
        outward: what Farhand says.
    """

    def __init__(self, options: Ros2Options, node: RosNode, link: Link, desk: Desk, clock: SystemClock,
                 session: Callable[[], int], tell: Callable[[str], None]) -> None:  # fmt: skip
        self.outward = Outward(node, options.robot, clock.epoch_ns(), desk.kept)

        def say(line: str) -> None:
            tell(line)
            self.outward.tell(line, clock.now_ns())

        self.refusals = Refusals(say)
        seats = self._seats(options, node, link, session) if options.steers else []
        self.node = BridgeNode(link, seats, self.outward.hand_on)
        pause = self._pause if options.steers else None
        self._services = Services(node, desk.estop, desk.acknowledge, pause, say)
        Parameters(node.types, parameters(options)).serve(node, say)
        self._say, self._said, self._trouble = say, "", ""

    def look(self, now_ns: int) -> None:
        """After each step: say what is new, and let time act on what is drawn."""
        self.outward.look(now_ns)
        if self.node.says != self._said:
            self._said = self.outward.steers = self.node.says
            self._say(self._said)
        self.outward.refused = dict(self.refusals.counts)
        if self.outward.trouble and self.outward.trouble != self._trouble:
            self._trouble = self.outward.trouble
            self._say(self._trouble)

    def close(self, now_ns: int) -> None:
        """Give the wheel up, and say what waits."""
        self.node.leave(now_ns)
        self._services.close()
        self.outward.close()

    def _pause(self, pauses: bool) -> None:
        self.node.paused = pauses

    def _seats(
        self, options: Ros2Options, node: RosNode, link: Link, session: Callable[[], int]
    ) -> list[tuple[Device, SteeringSender]]:
        twists = node.subscribe("~/delta_twist_cmds", TWIST, SENSOR)
        frames = TwistFrames(options.base_frame, options.tool_frame)
        hand = TwistHand(UNITS[options.command_type])
        driven = TwistDevice(
            twists, Reader(node.types, TWIST, node.key_of(twists)), frames, hand, self.refusals
        )
        joys = node.subscribe(options.joy_topic, JOY, SENSOR)
        joystick = JoyDevice(
            joys, Reader(node.types, JOY, node.key_of(joys)), options.joy_settings, self.refusals
        )
        return [
            (device, SteeringSender(options.robot, link, session(), "ros2", name))
            for device, name in ((driven, "ROS twists"), (joystick, "ROS joystick"))
        ]


def parameters(options: Ros2Options) -> dict[str, tuple[Value, str]]:
    """What the node says of itself: value and description by name."""
    found: dict[str, tuple[Value, str]] = {
        "use_sim_time": (False, "stamps are this host's time of day"),
        "robot": (options.robot, "name of the robot"),
        "side": (options.side, "of the network: operator or robot"),
    }
    if options.steers:
        settings = options.joy_settings
        found |= {
            "command_in_type": (options.command_type, "speed_units: m/s and rad/s; unitless: shares -1 to 1"),
            "base_frame": (options.base_frame, "frame_id of twists along base's axes"),
            "tool_frame": (options.tool_frame, "frame_id of twists along the tool's axes"),
            "incoming_command_timeout": (
                SILENCE_NS * 1e-9,
                "without a message for so long nothing moves (s)",
            ),
            "joy_topic": (options.joy_topic, "of the joystick"),
        }
        for name in ("deadman", "estop", "acknowledge", "turn_frame", "x", "y", "z", "roll", "pitch", "yaw"):
            found[f"joy.{name}"] = (getattr(settings, name), "what of the joystick does it")
    return found
