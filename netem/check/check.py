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
import subprocess
import sys
import tempfile
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec
import zenoh

from farhand.common.errors import EndpointError, FarhandError
from farhand.common.link.ports import free_ports
from farhand.common.link.zenoh_link import open_session
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.netem.check.judgement import judge
from farhand.netem.control import ask
from farhand.netem.measure.message_log import read_log
from farhand.netem.spec import parse_spec

KEYS = {"uplink": "farhand/check/command", "downlink": "farhand/check/state"}
START_TIMEOUT = 15.0
DRAIN_TIMEOUT = 90.0


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
        try:
            statistics = json.loads(stats.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            raise CheckError(
                f"the proxy could not write what it did to {folder}; is that disk full?"
            ) from None
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
        result[name] = judge(mine, spec, settings.seed, name, origin_ns, sent[name], arrived[name])
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
            clock.sleep_until(start_ns + to_ns(number / settings.rate_hz))
            try:
                self.session.put(
                    self._send_key,
                    number.to_bytes(8, "little") + rest,
                    express=True,
                    congestion_control=zenoh.CongestionControl.BLOCK,
                )
            except zenoh.ZError:  # the check was ended
                return
            self.sent += 1


def start_proxy(settings: dict[str, object]) -> subprocess.Popen[str]:
    """A proxy process that listens; `settings` are those of NetemSettings without the endpoints.

    Raises:
        EndpointError: its ports are taken.
        CheckError: it does not start.
    """
    process = subprocess.Popen(
        [sys.executable, "-m", "farhand.netem.main", json.dumps(settings | {"ready_fd": 1})],
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
