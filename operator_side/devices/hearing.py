"""What a device's program hears of the operator's: its newest report, and what that keeps a hand from."""

from farhand.common.link.link import Packet
from farhand.common.messages.codec import Decoder
from farhand.common.messages.echo import Newest
from farhand.common.messages.report import ControlReport
from farhand.operator_side.devices.hand import Obstacles
from farhand.operator_side.devices.resistance import resistance
from farhand.operator_side.supervision import NOT_ENGAGED

TAKES_NS = 500_000_000
"""So long after a press the operator's program must have taken it."""
LOST_AFTER = 1.0
"""Without news for so long nobody drives (s)."""
_LATCHED = ("stopped", "estop")


class Hearing:
    """Attributes:
    report: the newest; None before the first.
    """

    def __init__(self) -> None:
        self.report: ControlReport | None = None
        self._newest, self._decoder = Newest(), Decoder(ControlReport)

    def take(self, packet: Packet) -> None:
        """Take one packet of the reports' key; what is no report is left out."""
        report = self._decoder.decode(packet.payload)
        if report is not None and self._newest.accept(report, packet.arrived_ns):
            self.report = report

    def obstacles(self, now_ns: int) -> Obstacles:
        """What keeps a hand from driving at `now_ns`."""
        report = self.report
        if report is None:
            return Obstacles(lost="waiting for the operator's program")
        age = (now_ns - self._newest.arrived_ns) * 1e-9
        if age > LOST_AFTER:
            return Obstacles(lost="the operator's program is silent: press anew when it is back")
        if report.safety is None or report.state_age + age > LOST_AFTER:
            return Obstacles(lost="no news from the robot: press anew when it is back")
        if report.safety in _LATCHED:
            return Obstacles(stopped=f"the robot has latched a stop: {report.safety_reason}")
        return Obstacles()

    def refuses(self, pressed_ns: int, now_ns: int) -> bool:
        """Whether the newest report is of long after a press, and the operator's program takes no hand."""
        late = min(now_ns, self._newest.arrived_ns) - pressed_ns > TAKES_NS
        return late and self.report is not None and self.report.stop_reason == NOT_ENGAGED

    def resistance(self, now_ns: int) -> float:
        """How much of what is asked is not done, 0..1; what is lost is felt as nothing."""
        if self.report is None or self.obstacles(now_ns).lost:
            return 0.0
        return resistance(self.report)
