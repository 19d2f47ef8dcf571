"""What `farhand ros2` is asked for, checked at the edge."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from farhand.bridges.ros2.graph.wire import MAX_DOMAIN, check_namespace
from farhand.bridges.ros2.inbound.joy import JoySettings
from farhand.common.errors import InputError
from farhand.common.messages.steering import Unit
from farhand.common.scenario.section import checked_settings

SIDES = ("operator", "robot")
UNITS: Mapping[str, Unit] = {"speed_units": "si", "unitless": "share"}
"""As MoveIt Servo's `command_in_type` has them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ros2Options:
    """Attributes:
        router: endpoint of the ROS graph's Zenoh router.
        connect: the operator's report endpoint; with side `robot`, where the robot is heard.
        robot: the robot's name.
        side: `operator` or `robot`.
        domain: ROS_DOMAIN_ID.
        namespace: of the node.
        distro: whose types.
        command_type: what twists are in: `speed_units` or `unitless`.
        base_frame, tool_frame: what twists call the two.
        joy_topic: of the joystick.
        joy: what its axes and buttons do, where it is not the default.
        tls: certificate folder, for what of the two endpoints is `tls/`; empty: none.
        run: a recording that is told again; None: a running operator.
        speed: of that, times as fast as it was.
        realtime: ask for SCHED_FIFO.

    Raises:
        InputError: one of them cannot be.
    """

    router: str
    connect: str
    robot: str
    side: str = "operator"
    domain: int = 0
    namespace: str = "/farhand"
    distro: str = "jazzy"
    command_type: str = "speed_units"
    base_frame: str = "base"
    tool_frame: str = "tool"
    joy_topic: str = "/joy"
    joy: Mapping[str, object] = field(default_factory=dict)
    tls: str = ""
    run: Path | None = None
    speed: float = 1.0
    realtime: bool = True

    def __post_init__(self) -> None:
        if self.side not in SIDES:
            raise InputError(f"--side {self.side!r}: must be {' or '.join(SIDES)}")
        if self.command_type not in UNITS:
            raise InputError(f"--command-type {self.command_type!r}: must be {' or '.join(UNITS)}")
        if not 0 <= self.domain <= MAX_DOMAIN:
            raise InputError(f"--domain {self.domain}: must be 0 to {MAX_DOMAIN}")
        if self.base_frame == self.tool_frame:
            raise InputError(f"--tool-frame {self.tool_frame!r}: is the base frame's name as well")
        if self.tls and not (self.router.startswith("tls/") or self.connect.startswith("tls/")):
            raise InputError(f"--tls {self.tls}: no endpoint is secured; expected --router tls/HOST:PORT")
        if self.steers and self.connect.startswith("tls/"):
            raise InputError(f"--connect {self.connect}: an operator's reports stay on its host, not encrypted; "
                             "expected tcp/127.0.0.1:PORT as its --report has it")  # fmt: skip
        check_namespace(self.namespace)
        if not check_namespace(self.joy_topic, "--joy-topic"):
            raise InputError(f"--joy-topic {self.joy_topic!r}: expected a topic's full name such as /joy")
        _ = self.joy_settings

    @property
    def steers(self) -> bool:
        """Whether what comes from ROS may move anything."""
        return self.side == "operator"

    def tls_of(self, endpoint: str) -> str:
        """The certificate folder for an endpoint; empty: it is not secured."""
        return self.tls if endpoint.startswith("tls/") else ""

    @property
    def joy_settings(self) -> JoySettings:
        """What the joystick does."""
        found: JoySettings = checked_settings(dict(self.joy), _Joy, "joy")
        return found


class _Joy:
    Settings = JoySettings
