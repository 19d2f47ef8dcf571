"""Measure a real path by echo over Zenoh, and give it as a trace.

The one host runs `Reflector`, the other `record`. Each probe carries a session, a number and filling up to
the wanted size; the reflector sends it back as it is. The round trip is measured on one clock alone, in the
receiving callback. A probe without an echo `wait` seconds after the last was sent is lost.

Messages cross at Zenoh's "block" congestion control and "real time" priority, over the protocol of the
endpoint: over TCP a lost packet shows as a delay, not as a loss. Under "drop" a busy host's own queue lost
probes, which stood in the trace as a loss of the path; under "block" such a probe is late, as it was.
"""

import math
import secrets
import struct
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import zenoh
from numpy.typing import NDArray

from farhand.common.errors import InputError, TraceError
from farhand.common.link.zenoh_link import open_session
from farhand.common.timing.clock import NANOSECONDS_PER_SECOND, SystemClock, to_ns
from farhand.netem.recordings.formats.base import MAX_SAMPLES
from farhand.netem.recordings.trace import Trace

PROBE_KEY = "farhand/trace/probe"
ECHO_KEY = "farhand/trace/echo"
_HEADER = struct.Struct("<QI")
LARGEST = 1 << 20
# Longer than the session's lease: a path that stands still ends by the lease, not by a full queue.
_PATIENCE = (("transport/link/tx/queue/congestion_control/block/wait_before_close", 5_000_000),)


@dataclass(frozen=True)
class RecordSettings:
    """What to send.

    Attributes:
        connect, listen: Zenoh endpoints; at least one of both.
        rate_hz: probes per second.
        size: bytes of each.
        duration: of sending (s).
        wait: for echoes after the last probe (s).
        connect_timeout: until the reflector must have been seen (s).
    """

    connect: Sequence[str] = ()
    listen: Sequence[str] = ()
    rate_hz: float = 50.0
    size: int = 300
    duration: float = 20.0
    wait: float = 2.0
    connect_timeout: float = 5.0

    def __post_init__(self) -> None:
        for name, value, least, most in (
            ("--rate", self.rate_hz, 0.01, 10_000),
            ("--size", self.size, _HEADER.size, LARGEST),
            ("--seconds", self.duration, 0.01, 86_400),
            ("--wait", self.wait, 0, 600),
        ):
            if not (math.isfinite(value) and least <= value <= most):
                raise InputError(f"{name} {value}: must lie in {least} to {most}")
        if self.rate_hz * self.duration > MAX_SAMPLES:
            raise InputError(f"--rate times --seconds is more than {MAX_SAMPLES} messages; choose less")
        if not self.connect and not self.listen:
            raise InputError("give --connect with the reflector's endpoint, such as tcp/192.0.2.1:7450")


class Reflector:
    """Sends every probe back; to be closed with `close`.

    Args:
        connect, listen: Zenoh endpoints.

    Raises:
        EndpointError: an endpoint is malformed or taken.
    """

    def __init__(self, connect: Sequence[str] = (), listen: Sequence[str] = ()) -> None:
        self.reflected = 0
        self._queue: list[bytes] = []
        self._condition = threading.Condition()
        self._closing = False
        self._session = open_session(connect, listen, extra=_PATIENCE)
        self._publisher = _publisher(self._session, ECHO_KEY)
        self._thread = threading.Thread(target=self._reflect, name="reflector", daemon=True)
        self._thread.start()
        self._subscriber = self._session.declare_subscriber(PROBE_KEY, self._enqueue)

    def close(self) -> None:
        """Stop and leave the network."""
        with self._condition:
            self._closing = True
            self._condition.notify()
        self._thread.join(timeout=5)
        self._session.close()  # type: ignore[no-untyped-call]

    def _enqueue(self, sample: zenoh.Sample) -> None:
        payload = sample.payload.to_bytes()
        with self._condition:
            # A burst is answered, an endless backlog is not: the oldest go.
            del self._queue[:-4095]
            self._queue.append(payload)
            self._condition.notify()

    def _reflect(self) -> None:
        while True:
            with self._condition:
                while not self._queue and not self._closing:
                    self._condition.wait()
                if self._closing:
                    return
                waiting, self._queue = self._queue, []
            for payload in waiting:
                self._publisher.put(payload)
                self.reflected += 1


def record(
    settings: RecordSettings,
    clock: SystemClock,
    stop: threading.Event | None = None,
    on_progress: Callable[[int, int], None] | None = None,
) -> Trace:
    """Send probes and wait for their echoes.

    Args:
        settings: what to send.
        clock: of this process.
        stop: ends the sending early; what was sent so far is the trace.
        on_progress: called about once a second with (sent, received).

    Returns:
        round trips (s), timed at the instant of sending, NaN where no echo came.

    Raises:
        EndpointError: an endpoint is malformed or taken.
        TraceError: no reflector answers.
    """
    stop = stop or threading.Event()
    tag = secrets.randbits(64)
    count = max(1, round(settings.rate_hz * settings.duration))
    sent = np.zeros(count, dtype=np.int64)
    received = np.zeros(count, dtype=np.int64)
    arrivals = _Arrivals(clock, tag, received)
    session = open_session(settings.connect, settings.listen, extra=_PATIENCE)
    try:
        # The reference is held, or the subscription would end with it.
        subscriber = session.declare_subscriber(ECHO_KEY, arrivals.take)
        publisher = _publisher(session, PROBE_KEY)
        _await_reflector(publisher, settings, stop)
        filling = bytes(settings.size - _HEADER.size)
        period_ns = to_ns(1 / settings.rate_hz)
        start_ns = clock.now_ns()
        total = 0
        for index in range(count):
            clock.sleep_until(start_ns + index * period_ns)
            if stop.is_set():
                break
            sent[index] = clock.now_ns()
            publisher.put(_HEADER.pack(tag, index) + filling)
            total = index + 1
            if on_progress is not None and index % max(1, round(settings.rate_hz)) == 0:
                on_progress(total, arrivals.count)
        arrivals.wait_for(total, settings.wait)
        subscriber.undeclare()  # type: ignore[no-untyped-call]
    finally:
        session.close()  # type: ignore[no-untyped-call]
    if total == 0 or arrivals.count == 0:
        raise TraceError("trace record: not a single echo came back; is the reflector still running?")
    delays = np.where(
        received[:total] > 0, (received[:total] - sent[:total]) / NANOSECONDS_PER_SECOND, np.nan
    )
    times = (sent[:total] - sent[0]) / NANOSECONDS_PER_SECOND
    where = ", ".join((*settings.connect, *settings.listen))
    provenance = (
        f"farhand trace record, echo over Zenoh through {where}: "
        f"{settings.rate_hz:g} messages a second of {settings.size} bytes, {total} sent"
    )
    return Trace(delays, times, None, "round-trip", provenance)


class _Arrivals:
    """Notes when echoes arrive, in Zenoh's thread."""

    def __init__(self, clock: SystemClock, tag: int, received: NDArray[np.int64]) -> None:
        self._clock = clock
        self._tag = tag
        self._received = received
        self._condition = threading.Condition()
        self.count = 0

    def take(self, sample: zenoh.Sample) -> None:
        """Note an echo; what is not ours, or came twice, does not count."""
        now_ns = self._clock.now_ns()
        payload = sample.payload.to_bytes()
        if len(payload) < _HEADER.size:
            return
        tag, index = _HEADER.unpack_from(payload)
        if tag != self._tag or index >= len(self._received) or self._received[index]:
            return
        with self._condition:
            self._received[index] = now_ns
            self.count += 1
            self._condition.notify()

    def wait_for(self, total: int, timeout: float) -> None:
        """Until `total` echoes are there, or `timeout` (s) is over."""
        with self._condition:
            self._condition.wait_for(lambda: self.count >= total, timeout)


def _publisher(session: zenoh.Session, key: str) -> zenoh.Publisher:
    return session.declare_publisher(
        key,
        congestion_control=zenoh.CongestionControl.BLOCK,
        priority=zenoh.Priority.REAL_TIME,
        express=True,
    )


def _await_reflector(publisher: zenoh.Publisher, settings: RecordSettings, stop: threading.Event) -> None:
    """Until somebody subscribes to the probes; raises TraceError if nobody does in time."""
    clock = SystemClock()
    deadline_ns = clock.now_ns() + to_ns(settings.connect_timeout)
    # The stub says bool; what comes is an object with a field, which is always true itself.
    while not publisher.matching_status.matching:  # type: ignore[attr-defined]
        if clock.now_ns() > deadline_ns or stop.wait(0.05):
            where = ", ".join((*settings.connect, *settings.listen))
            raise TraceError(
                f"trace record: no reflector at {where} after {settings.connect_timeout:g} s; "
                "start `farhand trace record --listen ...` on the other host"
            )
