"""What pages say over the console's web socket: one drives, another one says anything, then the driver does."""

from collections.abc import Callable
from typing import Any

import msgspec

from farhand.common.link.link import Packet
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.keys import mirror_key, report_key
from farhand.common.messages.steering import Steering
from farhand.operator_side.console.console import Console
from farhand.operator_side.console.said import Hello, Pictured, SaidError, read_said
from farhand.trials.fuzz.target import Target, check, one_line
from farhand.trials.fuzz.targets.wire.operator_messages import description, report, scene, state

MS = 1_000_000
NOW_NS = 9_000_000_000
DRIVER, OTHER = 1, 2


class _Operator:
    """The operator's program as the console meets it."""

    def __init__(self) -> None:
        self.told: list[Steering] = []
        self.now_ns = NOW_NS
        self._decoder = Decoder(Steering)
        command = VelocityCommand(
            source="operator", session=1_000_007, seq=5, t_sent_ns=1, mode="run", velocity=(0.1, 0.0, 0.0)
        )
        self._says = {
            report_key("r"): encode(report()),
            mirror_key("r", "state"): encode(state()),
            mirror_key("r", "scene"): encode(scene(obstacles=())),
            mirror_key("r", "description"): encode(description()),
            mirror_key("r", "command"): encode(command),
        }

    def send(self, packet: Packet) -> None:
        said = self._decoder.decode(packet.payload)
        check(said is not None, "the console says what the operator's program refuses")
        assert said is not None
        self.told.append(said)

    def receive(self) -> list[Packet]:
        return [Packet(key, payload, self.now_ns) for key, payload in self._says.items()]


def seeds() -> list[bytes]:
    """Each kind of message, behind a byte that says whether the driver says it."""
    said: list[dict[str, Any]] = [
        {"kind": "hello", "page": "b", "token": "t"},
        {
            "kind": "steer",
            "n": 50,
            "t": 500.0,
            "engaged": True,
            "press": 2,
            "linear": (1.0, 0.0, 0.0),
            "seen": 9000,
        },
        {"kind": "steer", "n": 51, "t": 510.0, "engaged": False, "press": 2},
        {"kind": "pictured"},
        {"kind": "network", "n": 52, "name": "5g-urban"},
        {"kind": "outage", "n": 53, "seconds": 2.0},
    ]
    said += [
        {"kind": "do", "n": 54, "what": what} for what in ("estop", "acknowledge", "take", "release", "give")
    ]
    return [bytes([who]) + msgspec.msgpack.encode(each) for who in (0, 1) for each in said]


def start() -> Callable[[bytes], None]:
    """See Target."""

    def take(data: bytes) -> None:
        operator = _Operator()
        console = Console("r", operator, 5)
        for number in (DRIVER, OTHER):
            console.seat.join(number, f"page {number}", NOW_NS)
        console.beat(NOW_NS)
        console.hear(DRIVER, _said({"kind": "do", "n": 1, "what": "take"}), NOW_NS)
        who = OTHER if data[:1] in (b"", b"\0") else DRIVER
        operator.now_ns = NOW_NS + 20 * MS
        try:
            said = read_said(data[1:])
        except SaidError as error:
            one_line(error)
            said = None
        if said is not None and not isinstance(said, Hello | Pictured):
            console.hear(who, said, NOW_NS + 20 * MS)
        for step in range(3):
            operator.now_ns = NOW_NS + (25 + 20 * step) * MS
            console.beat(operator.now_ns)
            msgspec.msgpack.encode(console.frame(who, operator.now_ns))
        # Nobody has pressed anything in time: the first message of a page never counts.
        check(not any(each.engaged for each in operator.told), "moved by one message of a page")

    return take


def _said(message: dict[str, Any]) -> Any:
    return read_said(msgspec.msgpack.encode(message))


TARGET = Target(
    edge="messages of the console's web socket",
    promise="no single message moves anything, whoever says it",
    seeds=seeds,
    start=start,
    shape="map",
    head=1,
)
