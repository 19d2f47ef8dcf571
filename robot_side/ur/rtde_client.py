"""Farhand's end of an RTDE connection. Never waits, so that a control loop can own it; connects anew by itself."""

import errno
import socket
import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from farhand.common.timing.clock import to_ns
from farhand.robot_side.ur.rtde_codec import (
    DATA,
    IN_USE,
    INPUTS,
    NOT_FOUND,
    OUTPUTS,
    START,
    URCONTROL,
    VERSION,
    BrokenStreamError,
    Package,
    Recipe,
    pack,
    take,
)

RTDE_PORT = 30004
PROTOCOL = 2
PATIENCE = 1.0
"""s without progress after which a connection that is being made is given up."""
PAUSE = 0.5
"""s before it is tried again."""
E_SERIES, FAST, SLOW = 5, 500.0, 125.0
"""Controllers from this major version on have 500 Hz; those before have 125 Hz."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """Attributes:
    outputs: variables to be received.
    optional: of them, those that a controller may lack.
    inputs: variables to be sent; empty: none.
    """

    outputs: tuple[str, ...]
    optional: tuple[str, ...] = ()
    inputs: tuple[str, ...] = ()


class RtdeClient:
    """A connection that is polled.

    Args:
        host: address of the controller.
        wanted: what travels.
        port: of its RTDE.

    Attributes:
        values: the newest of each output, by name; empty before the first.
        arrived_ns: when they came; None before the first.
        version: of the controller's software, such as (5, 12, 0, 1101319); None before it is known.
        trouble: why there is no connection, for people; empty while there is one.
        fresh: the values of every data package that the last poll brought, in order.
    """

    def __init__(self, host: str, wanted: Wanted, port: int = RTDE_PORT) -> None:
        self._address, self._wanted = (host, port), wanted
        self._socket: socket.socket | None = None
        self._buffer, self._unsent = bytearray(), bytearray()
        self._names: tuple[str, ...] = wanted.outputs
        self._outputs: Recipe | None = None
        self._inputs: Recipe | None = None
        self._connecting = False
        self._progress_ns = 0
        self._again_ns: int | None = None
        self._started = False
        self.values: dict[str, Any] = {}
        self.arrived_ns: int | None = None
        self.version: tuple[int, int, int, int] | None = None
        self.trouble = "not connected yet"
        self.fresh: list[dict[str, Any]] = []
        self._answers: dict[int, Callable[[bytes, int], None]] = {
            VERSION: self._on_version,
            URCONTROL: self._on_control_version,
            OUTPUTS: self._on_outputs,
            INPUTS: self._on_inputs,
            START: self._on_start,
            DATA: self._on_data,
        }

    @property
    def rate_hz(self) -> float:
        """Of the controller's cycles."""
        return FAST if self.version is not None and self.version[0] >= E_SERIES else SLOW

    @property
    def local_address(self) -> str:
        """This host's, as the controller sees it; empty while not connected."""
        return str(self._socket.getsockname()[0]) if self._socket is not None and not self._connecting else ""

    def poll(self, now_ns: int) -> int:
        """Go on with whatever is due; returns how many data packages came."""
        self.fresh = []
        if self._socket is None:
            if self._again_ns is None or now_ns >= self._again_ns:
                self._connect(now_ns)
            return 0
        try:
            if self._connecting and not self._connected(now_ns):
                return 0
            self._flush()
            self._read(now_ns)
        except (OSError, BrokenStreamError, struct.error, UnicodeDecodeError, KeyError) as error:
            self._give_up(_words(error), now_ns)
        if self._socket is not None and not self._started and now_ns - self._progress_ns > to_ns(PATIENCE):
            self._give_up("it does not answer", now_ns)
        return len(self.fresh)

    def send(self, values: Sequence[Any]) -> bool:
        """Send the inputs; whether that could be done at once and whole."""
        if self._inputs is None or not self._started or self._socket is None or self._unsent:
            return False
        self._unsent += pack(DATA, self._inputs.pack(values))
        try:
            self._flush()
        except OSError:
            return False  # the next poll finds out
        return not self._unsent

    def close(self) -> None:
        """Hang up, for good until the next poll."""
        if self._socket is not None:
            self._socket.close()
        self._socket, self._started, self._connecting = None, False, False

    def _connect(self, now_ns: int) -> None:
        self._buffer, self._unsent = bytearray(), bytearray()
        self._names, self._outputs, self._inputs = self._wanted.outputs, None, None
        self._started, self._connecting, self._progress_ns = False, True, now_ns
        sock = socket.socket()
        sock.setblocking(False)
        self._socket = sock
        try:
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            code = sock.connect_ex(self._address)
        except OSError as error:
            self._give_up(_words(error), now_ns)
            return
        if code not in (0, errno.EINPROGRESS):
            self._give_up(_words(OSError(code, "")), now_ns)

    def _connected(self, now_ns: int) -> bool:
        sock = self._socket
        assert sock is not None
        code = sock.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
        if code:
            raise OSError(code, "")
        try:
            sock.getpeername()
        except OSError:
            if now_ns - self._progress_ns > to_ns(PATIENCE):
                self._give_up("nobody answers at this address", now_ns)
            return False
        self._connecting, self._progress_ns = False, now_ns
        self._unsent += pack(VERSION, struct.pack(">H", PROTOCOL))
        return True

    def _flush(self) -> None:
        if self._unsent and self._socket is not None:
            try:
                sent = self._socket.send(self._unsent)
            except BlockingIOError:
                return
            del self._unsent[:sent]

    def _read(self, now_ns: int) -> None:
        sock = self._socket
        assert sock is not None
        while True:
            try:
                data = sock.recv(65_536)
            except BlockingIOError:
                break
            if not data:
                raise ConnectionResetError(errno.ECONNRESET, "")
            self._buffer += data
            if len(data) < 65_536:
                break
        for package in take(self._buffer):
            self._handle(package, now_ns)

    def _handle(self, package: Package, now_ns: int) -> None:
        answer = self._answers.get(package.kind)
        if answer is not None:
            self._progress_ns = now_ns
            answer(package.payload, now_ns)

    def _on_version(self, payload: bytes, now_ns: int) -> None:
        if payload[:1] != b"\1":
            raise BrokenStreamError("its RTDE is older than version 2")
        self._unsent += pack(URCONTROL)

    def _on_control_version(self, payload: bytes, now_ns: int) -> None:
        self.version = struct.unpack(">4I", payload)
        self._ask_outputs()

    def _ask_outputs(self) -> None:
        self._unsent += pack(OUTPUTS, struct.pack(">d", self.rate_hz) + ",".join(self._names).encode())

    def _on_outputs(self, payload: bytes, now_ns: int) -> None:
        types = payload[1:].decode().split(",")
        if not payload or len(types) != len(self._names):
            raise BrokenStreamError("its answer to the outputs is none")
        missing = {name for name, kind in zip(self._names, types, strict=True) if kind == NOT_FOUND}
        if missing - set(self._wanted.optional):
            raise BrokenStreamError(f"it has no {sorted(missing)[0]}")
        if missing:
            self._names = tuple(name for name in self._names if name not in missing)
            self._ask_outputs()
            return
        self._outputs = Recipe(payload[0], self._names, types)
        if self._wanted.inputs:
            self._unsent += pack(INPUTS, ",".join(self._wanted.inputs).encode())
        else:
            self._unsent += pack(START)

    def _on_inputs(self, payload: bytes, now_ns: int) -> None:
        types = payload[1:].decode().split(",")
        if not payload:
            raise BrokenStreamError("its answer to the inputs is none")
        if IN_USE in types:
            raise BrokenStreamError(
                "another client is in control: it owns the input registers that Farhand needs"
            )
        if NOT_FOUND in types or len(types) != len(self._wanted.inputs):
            raise BrokenStreamError("it lacks the input registers that Farhand needs")
        self._inputs = Recipe(payload[0], self._wanted.inputs, types)
        self._unsent += pack(START)

    def _on_start(self, payload: bytes, now_ns: int) -> None:
        if payload[:1] != b"\1":
            raise BrokenStreamError("it does not start to send")
        self._started, self.trouble = True, ""

    def _on_data(self, payload: bytes, now_ns: int) -> None:
        if self._outputs is None:
            return
        self.values = dict(zip(self._names, self._outputs.unpack(payload), strict=True))
        self.arrived_ns = now_ns
        self.fresh.append(self.values)

    def _give_up(self, why: str, now_ns: int) -> None:
        self.close()
        self.trouble, self._again_ns = why, now_ns + to_ns(PAUSE)


def _words(error: Exception) -> str:
    if isinstance(error, KeyError):
        return f"it has a type that is not known: {error}"
    if isinstance(error, BrokenStreamError | struct.error | UnicodeDecodeError):
        return str(error)
    number = getattr(error, "errno", None)
    return {
        errno.ECONNREFUSED: "no controller listens at this address",
        errno.ECONNRESET: "it hung up",
        errno.EHOSTUNREACH: "there is no way to this address",
        errno.ENETUNREACH: "there is no way to this address",
        errno.ETIMEDOUT: "nobody answers at this address",
    }.get(number or 0, str(error) or f"error {number}")
