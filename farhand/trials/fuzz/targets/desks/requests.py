"""What recorders ask the operator's program and the emulator for."""

from collections.abc import Callable

import msgspec

from farhand.common.link.link import memory_wire
from farhand.common.recording.records import RunInfo
from farhand.netem.emulation import Emulation
from farhand.netem.fate_server import FateServer
from farhand.netem.measure.fate_history import FateHistory
from farhand.netem.netem_node import NetemNode
from farhand.netem.spec import parse_spec
from farhand.operator_side.accounts.tick_history import TickHistory
from farhand.site.tick_server import TickServer
from farhand.trials.fuzz.target import Target, check


def seeds() -> list[bytes]:
    """A request for each, behind a byte that says which."""
    return [
        b"\0" + msgspec.json.encode({"since": 3}),
        b"\1" + msgspec.json.encode({"since": 3, "written": 2}),
    ]


def start() -> Callable[[bytes], None]:
    """See Target."""
    spec = parse_spec("none")
    node = NetemNode(memory_wire()[0], memory_wire()[0], Emulation(spec, spec, 1))
    # Their beginnings open a Zenoh session and a thread; what answers needs neither.
    fates, ticks = FateServer.__new__(FateServer), TickServer.__new__(TickServer)
    fates._history, fates._node, fates._seed = FateHistory(), node, 1
    fates._epoch_ns = fates._session = 1
    ticks._history, ticks._now_ns = TickHistory(), lambda: 1
    ticks._info = RunInfo(scenario={}, robot="r", session=7, seed=1, versions={})
    ticks._ended = False

    def take(data: bytes) -> None:
        ticks._written, ticks._written_ns, ticks._asked = -1, None, False
        server: FateServer | TickServer = ticks if data[:1] == b"\1" else fates
        batch = server.answer(data[1:])
        if batch is not None:
            msgspec.msgpack.encode(batch)
            check(msgspec.json.decode(data[1:])["since"] >= -1, "a batch that nobody asked for")

    return take


TARGET = Target(
    edge="requests of recorders, at the operator's program and at netem",
    promise="what is none gets no batch, and the next one is answered",
    seeds=seeds,
    start=start,
    shape="json",
    head=1,
    longest=1024,
)
