"""`farhand netem check`: the real proxy over loopback, asked whether it did what it drew.

The proxy runs as a process of its own; this process sends on both sides and receives on both. The proxy
logs every message. Then, for each direction:

- counts: sent = taken in; delivered = arrived; what is missing was drawn as lost;
- error: achieved minus assigned delay of every delivered message;
- distribution: two-sample Kolmogorov-Smirnov test of the achieved delays against those of the same SPEC
  with another seed, drawn in virtual time for the same arrivals;
- replay: the same SPEC and seed in virtual time, for the same arrivals, gives the same fates and delays.
"""

import json
import socket
import subprocess
import sys
import tempfile
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import zenoh
from numpy.typing import NDArray
from scipy.stats import ks_2samp

from common.clock import SystemClock, to_ns
from common.errors import EndpointError, FarhandError
from common.link import Packet
from common.zenoh_link import open_session
from netem.chain import Chain
from netem.control import ask
from netem.message_log import read_log
from netem.spec import Spec, parse_spec

KEYS = {"uplink": "farhand/check/command", "downlink": "farhand/check/state"}
START_TIMEOUT = 15.0
DRAIN_TIMEOUT = 90.0
MIN_KS_SAMPLES = 20


class CheckError(FarhandError):
    """The check itself could not be done."""


class CheckSettings(msgspec.Struct, frozen=True, kw_only=True):
    """What to check.

    Attributes:
        uplink, downlink: SPECs.
        rate_hz: messages a second, each way.
        seconds: how long to send (s).
        size: payload (bytes), at least 8.
        seed: of the draws.
        realtime: let the proxy ask for SCHED_FIFO.
        ports: of the proxy on loopback (operator, robot, control); None chooses free ones.
    """

    uplink: str
    downlink: str
    rate_hz: float = 500.0
    seconds: float = 20.0
    size: int = 300
    seed: int = 1
    realtime: bool = True
    ports: tuple[int, int, int] | None = None


def run_check(settings: CheckSettings) -> dict[str, Any]:
    """Do it; returns the findings as plain values, durations in s.

    Raises:
        InputError: a SPEC or a port cannot be used.
        CheckError: the proxy did not start or did not end.
    """
    specs = {"uplink": parse_spec(settings.uplink), "downlink": parse_spec(settings.downlink)}
    for spec in specs.values():
        spec.prepare()
    with tempfile.TemporaryDirectory(prefix="farhand-netem-") as folder:
        log, stats = Path(folder) / "log.csv", Path(folder) / "stats.json"
        sent, arrived = _run(settings, log, stats)
        statistics = json.loads(stats.read_text(encoding="utf-8"))
        rows = read_log(log)
    result: dict[str, Any] = {
        "rate_hz": settings.rate_hz,
        "seconds": settings.seconds,
        "size": settings.size,
        "seed": settings.seed,
        "realtime_priority": statistics["realtime_priority"],
        "conserved": statistics["conserved"] and not statistics["overflowed"],
    }
    origin_ns = int(rows["arrived_ns"].min()) if len(rows) else 0
    for name, spec in specs.items():
        mine = rows[(rows["direction"] == name) & (rows["key"] == KEYS[name])]
        result[name] = _judge(mine, spec, settings.seed, name, origin_ns, sent[name], arrived[name])
    result["passed"] = bool(
        result["conserved"] and all(result[n]["accounted"] and result[n]["replays"] for n in specs)
    )
    return result


class _End:
    """One side's program: sends numbered messages, notes the numbers that arrive."""

    def __init__(self, endpoint: str, send_key: str, receive_key: str) -> None:
        self.session = open_session([endpoint])
        self.connected = threading.Event()
        self.arrived: list[int] = []
        self.sent = 0
        self._send_key = send_key
        self.session.info.declare_transport_events_listener(lambda _: self.connected.set(), history=True)
        self.session.declare_subscriber(receive_key, self._receive)

    def _receive(self, sample: zenoh.Sample) -> None:
        self.arrived.append(int.from_bytes(sample.payload.to_bytes()[:8], "little"))

    def send(self, clock: SystemClock, settings: CheckSettings, phase: float) -> None:
        """Send at absolute deadlines."""
        start_ns = clock.now_ns() + to_ns(phase)
        rest = bytes(max(0, settings.size - 8))
        for number in range(round(settings.rate_hz * settings.seconds)):
            clock.sleep_until(start_ns + round(number * 1e9 / settings.rate_hz))
            self.session.put(
                self._send_key,
                number.to_bytes(8, "little") + rest,
                express=True,
                congestion_control=zenoh.CongestionControl.BLOCK,
            )
            self.sent += 1


def start_proxy(settings: dict[str, object]) -> subprocess.Popen[str]:
    """A proxy process that listens; `settings` are those of NetemSettings without the endpoints.

    Raises:
        EndpointError: its ports are taken.
        CheckError: it does not start.
    """
    process = subprocess.Popen(
        [sys.executable, "-m", "netem.main", json.dumps(settings | {"ready_fd": 1})],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert process.stderr is not None
    for line in process.stdout:
        if line.strip() == "ready":
            return process
    code = process.wait(START_TIMEOUT)
    reason = process.stderr.read().strip().splitlines()
    process.stderr.close()
    process.stdout.close()
    kind = EndpointError if code == 2 else CheckError
    raise kind(reason[-1] if reason else f"the proxy ended with code {code}")


def stop_proxy(process: subprocess.Popen[str]) -> None:
    """End a proxy and wait for it; raises CheckError if it failed."""
    process.terminate()
    try:
        _, errors = process.communicate(timeout=DRAIN_TIMEOUT)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        raise CheckError("the proxy did not end when asked to") from None
    if process.returncode != 0:
        raise CheckError(errors.strip() or f"the proxy ended with code {process.returncode}")


def free_ports(count: int) -> list[int]:
    """Ports on loopback that were free a moment ago, below the range of outgoing connections."""
    found: list[int] = []
    sockets: list[socket.socket] = []
    port = 20_000 + (SystemClock().now_ns() // 1000) % 10_000
    while len(found) < count:
        candidate = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        try:
            candidate.bind(("127.0.0.1", port))
            found.append(port)
            sockets.append(candidate)
        except OSError:
            candidate.close()
        port = 20_000 + (port + 1 - 20_000) % 12_000
    for each in sockets:
        each.close()
    return found


def _run(settings: CheckSettings, log: Path, stats: Path) -> tuple[dict[str, int], dict[str, list[int]]]:
    """Run the traffic; numbers sent, and those that arrived in order of arrival, by direction."""
    endpoints = [f"tcp/127.0.0.1:{port}" for port in settings.ports or free_ports(3)]
    operator_endpoint, robot_endpoint, control = endpoints
    process = start_proxy(
        {
            "listen_operator": operator_endpoint,
            "listen_robot": robot_endpoint,
            "uplink": settings.uplink,
            "downlink": settings.downlink,
            "seed": settings.seed,
            "stats": str(stats),
            "log": str(log),
            "realtime": settings.realtime,
            "control": control,
        }
    )
    ends: list[_End] = []
    try:
        ends.append(_End(operator_endpoint, KEYS["uplink"], KEYS["downlink"]))
        ends.append(_End(robot_endpoint, KEYS["downlink"], KEYS["uplink"]))
        _wait_for_way(ends)
        clock = SystemClock()
        threads = [
            threading.Thread(target=end.send, args=(clock, settings, index / settings.rate_hz / 2))
            for index, end in enumerate(ends)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        _drain(ends, control)
    finally:
        stop_proxy(process)
        for end in ends:
            end.session.close()  # type: ignore[no-untyped-call]
    operator, robot = ends
    sent = {"uplink": operator.sent, "downlink": robot.sent}
    return sent, {"uplink": robot.arrived, "downlink": operator.arrived}


def _wait_for_way(ends: Sequence[_End]) -> None:
    """Until both ends are connected and the proxy has heard what they subscribe to."""
    for end in ends:
        if not end.connected.wait(START_TIMEOUT):
            raise CheckError("an end could not connect to the proxy")
    pause = threading.Event()
    pause.wait(0.5)


def _drain(ends: Sequence[_End], control: str) -> None:
    """Until the proxy holds nothing more and nothing more arrives."""
    pause = threading.Event()
    for _ in range(round(DRAIN_TIMEOUT / 0.5)):
        before = sum(len(end.arrived) for end in ends)
        pause.wait(0.5)
        if sum(len(end.arrived) for end in ends) != before:
            continue
        statistics = ask(control, {"do": "show"})["statistics"]
        if not statistics["uplink"]["queued"] and not statistics["downlink"]["queued"]:
            return


def _judge(
    rows: NDArray[np.void],
    spec: Spec,
    seed: int,
    direction: str,
    origin_ns: int,
    sent: int,
    arrived: list[int],
) -> dict[str, Any]:
    """The findings of one direction."""
    delivered = rows[rows["achieved_ns"] >= 0]
    taken = int(np.sum(rows["copy"] == 0))
    lost = {str(c): int(n) for c, n in zip(*np.unique(rows["fate"], return_counts=True), strict=True)}
    lost.pop("delivered", None)
    achieved, drawn = delivered["achieved_ns"] * 1e-9, delivered["drawn_ns"] * 1e-9
    assigned = delivered["assigned_ns"] * 1e-9
    originals = np.sort(rows[rows["copy"] == 0], order="ordinal")
    replayed = _virtual(originals, spec, seed, direction, origin_ns)
    reference = _virtual(originals, spec, seed + 1, direction, origin_ns)
    expected = reference["assigned_ns"][reference["fate"] == "delivered"] * 1e-9
    same = bool(
        len(replayed) == len(rows)
        and np.array_equal(_ordered(replayed)["fate"], _ordered(rows)["fate"])
        and np.array_equal(_ordered(replayed)["assigned_ns"], _ordered(rows)["assigned_ns"])
    )
    found: dict[str, Any] = {
        "spec": str(spec),
        "sent": sent,
        "taken_in": taken,
        "duplicated": len(rows) - taken,
        "lost_as_drawn": lost,
        "delivered": len(delivered),
        "arrived": len(arrived),
        "accounted": sent == taken and len(delivered) == len(arrived) and sent > 0,
        "reordered_as_drawn": _overtaken(_by_release(delivered)),
        "reordered_on_arrival": _overtaken(arrived),
        "drawn": _describe(drawn),
        "assigned": _describe(assigned),
        "achieved": _describe(achieved),
        "error": _describe(np.maximum(0.0, achieved - assigned)),
        "replays": same,
    }
    if len(achieved) >= MIN_KS_SAMPLES and len(expected) >= MIN_KS_SAMPLES:
        test = ks_2samp(achieved, expected)
        found["ks"] = {"statistic": float(test.statistic), "p": float(test.pvalue), "n": len(achieved)}
    return found


def _virtual(
    originals: NDArray[np.void], spec: Spec, seed: int, direction: str, origin_ns: int
) -> NDArray[np.void]:
    """The rows that the same arrivals give in virtual time."""
    chain = Chain(spec, seed, direction)
    offset_ns = 3_600_000_000_000 - origin_ns  # times on the wire are positive
    chain.start(origin_ns + offset_ns)
    rows = []
    for original in originals:
        arrived_ns = int(original["arrived_ns"]) + offset_ns
        packet = Packet(str(original["key"]), bytes(int(original["size"])), arrived_ns)
        for transit in chain.offer(packet, arrived_ns):
            assigned_ns = transit.release_ns - arrived_ns
            rows.append(
                (
                    direction,
                    packet.key,
                    transit.ordinal,
                    int(transit.is_copy),
                    transit.size,
                    int(original["arrived_ns"]),
                    transit.delay_ns,
                    assigned_ns,
                    -1 if transit.cause else assigned_ns,
                    transit.cause or "delivered",
                )
            )
    return np.array(rows, dtype=originals.dtype)


def _ordered(rows: NDArray[np.void]) -> NDArray[np.void]:
    return np.sort(rows, order=["ordinal", "copy"])


def _by_release(rows: NDArray[np.void]) -> list[int]:
    """Ordinals in the order in which they were to be released."""
    order = np.argsort(rows["arrived_ns"] + rows["assigned_ns"], kind="stable")
    found: list[int] = rows["ordinal"][order].tolist()
    return found


def _overtaken(numbers: Sequence[int]) -> int:
    """How many come after a larger one."""
    newest, count = -1, 0
    for number in numbers:
        if number < newest:
            count += 1
        newest = max(newest, number)
    return count


def _describe(values: NDArray[np.float64]) -> dict[str, float]:
    if not len(values):
        return dict.fromkeys(("mean", "std", "p50", "p99", "max"), 0.0)
    return {
        "mean": float(values.mean()),
        "std": float(values.std()),
        "p50": float(np.percentile(values, 50)),
        "p99": float(np.percentile(values, 99)),
        "max": float(values.max()),
    }
