"""Round trips, measured from the echoes that pass through: command in, ..., state that echoes it out.

RTT = (state leaves the emulator) - (command reached it) - (the robot's hold). Both instants are the
emulator's own; no two clocks are compared. It is the emulated network plus the real way to the robot and
back, without the operator's own link.
"""

from collections import OrderedDict

import msgspec

from farhand.common.messages.base import Echo, Stamp
from farhand.netem.measure.histogram import Histogram

KEPT = 4096
MAX_ROBOTS = 256
MAX_SESSIONS = 256


class _Stamps(msgspec.Struct):
    """The few fields of any message that matter here; all others are passed over."""

    session: Stamp
    seq: Stamp
    t_sent_ns: Stamp = 0
    echo: Echo | None = None


class CommandMark(msgspec.Struct):
    """A command on its way.

    Attributes:
        arrived_ns: when it reached the emulator.
        delivered: whether it has left for the robot.
    """

    arrived_ns: int
    delivered: bool = False


class EchoMark(msgspec.Struct):
    """A state on its way back.

    Attributes:
        command: what it echoes.
        hold_ns: how long the robot had it.
    """

    command: CommandMark
    hold_ns: int


class RoundTrips:
    """Round trips of one robot.

    Attributes:
        rtt: of the network between command and state.
        bypassed: states that echo a command which the emulator had not let through.
        offsets_ns: of each operator's session, the newest of them: the emulator's clock at its first command less the
            stamp on it (ns).
    """

    def __init__(self) -> None:
        self.rtt = Histogram()
        self.bypassed = 0
        self.offsets_ns: OrderedDict[int, int] = OrderedDict()
        self._decoder = msgspec.msgpack.Decoder(_Stamps)
        self._commands: OrderedDict[tuple[int, int], CommandMark] = OrderedDict()
        self._session, self._newest = -1, -1

    def command(self, payload: bytes, arrived_ns: int) -> CommandMark | None:
        """Note a command that came in; None if it is not readable."""
        stamps = self._decode(payload)
        if stamps is None:
            return None
        if stamps.session not in self.offsets_ns:
            self.offsets_ns[stamps.session] = arrived_ns - stamps.t_sent_ns
            if len(self.offsets_ns) > MAX_SESSIONS:
                self.offsets_ns.popitem(last=False)
        mark = CommandMark(arrived_ns)
        self._commands[stamps.session, stamps.seq] = mark
        if stamps.session != self._session:
            self._session, self._newest = stamps.session, stamps.seq
        self._newest = max(self._newest, stamps.seq)
        if len(self._commands) > KEPT:
            self._commands.popitem(last=False)
        return mark

    def echo(self, payload: bytes) -> EchoMark | None:
        """Note a message from the robot; None if it echoes no command that is known."""
        stamps = self._decode(payload)
        if stamps is None or stamps.echo is None:
            return None
        echo = stamps.echo
        mark = self._commands.get((echo.session, echo.seq))
        if mark is None:
            if echo.session == self._session and echo.seq > self._newest:
                self.bypassed += 1
            return None
        if not mark.delivered:
            self.bypassed += 1
            return None
        return EchoMark(mark, echo.hold_ns)

    def returned(self, mark: EchoMark, now_ns: int) -> None:
        """The message with this echo has left for the operator."""
        self.rtt.add(max(0, now_ns - mark.command.arrived_ns - mark.hold_ns))

    def _decode(self, payload: bytes) -> _Stamps | None:
        try:
            return self._decoder.decode(payload)
        except (msgspec.MsgspecError, ValueError, RecursionError, OverflowError):
            return None
