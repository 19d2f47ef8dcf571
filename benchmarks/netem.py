"""How good the emulator is: error of its delays, capacity, and what it adds to a round trip.

`python benchmarks/netem.py [--json FILE] [--quick]`. Run it on an idle machine; compare ratios, not
microseconds, between machines.
"""

import argparse
import json
import os
import queue
import socket
import statistics
import subprocess
import sys
import threading
from pathlib import Path

import zenoh
from rich.console import Console
from rich.table import Table

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from farhand.common.link.ports import free_ports
from farhand.common.link.zenoh_link import open_session
from farhand.common.timing.clock import SystemClock
from farhand.netem.check.check import CheckSettings, run_check, start_proxy, stop_proxy

TARGET_P99 = 2e-3
RATES = {300: (500, 1000, 2000, 3000, 4000, 6000), 30_000: (100, 250, 500, 1000, 1500, 2000)}
PING, PONG = "farhand/bench/command", "farhand/bench/state"


def run(quick: bool = False) -> dict[str, object]:
    """All measurements as plain values; durations in s, rates in messages/s each way."""
    return {
        "processors": os.cpu_count(),
        "error": error((False,), 0.3) if quick else error((True, False), 10.0),
        "capacity": {
            str(size): capacity(size, rates[:1] if quick else rates, 0.3 if quick else 3.0)
            for size, rates in list(RATES.items())[: 1 if quick else None]
        },
        "round_trip": round_trips(20 if quick else 2000),
    }


def error(priorities: tuple[bool, ...], seconds: float) -> dict[str, object]:
    """Achieved minus drawn delay at constant 20 ms, 500 messages/s each way."""
    found: dict[str, object] = {}
    for realtime in priorities:
        name = "SCHED_FIFO" if realtime else "plain"
        result = run_check(
            CheckSettings(uplink="constant:20", downlink="constant:20", seconds=seconds, realtime=realtime)
        )
        if realtime and not result["realtime_priority"]:
            found[name] = None
            continue
        found[name] = {
            q: max(result[d]["error"][q] for d in ("uplink", "downlink")) for q in ("p50", "p99", "max")
        }
    return found


def capacity(size: int, rates: tuple[int, ...], seconds: float) -> dict[str, object]:
    """The highest rate at which the worse direction's p99 error stays under 2 ms and nothing is lost.

    The traffic comes from a Python process on the same machine, which is the first to tire.
    """
    best, table = 0, {}
    for rate in rates:
        result = run_check(
            CheckSettings(
                uplink="constant:20", downlink="constant:20", rate_hz=rate, seconds=seconds, size=size
            )
        )
        p99 = max(result[d]["error"]["p99"] for d in ("uplink", "downlink"))
        table[str(rate)] = {"p99": p99, "accounted": result["passed"]}
        if p99 > TARGET_P99 or not result["passed"]:
            break
        best = rate
    return {"messages_per_second": best, "robots_at_100_hz": best // 100, "by_rate": table}


def round_trips(count: int) -> dict[str, object]:
    """Median and p99 of a 300-byte round trip: raw UDP, direct Zenoh, through the proxy with no delay."""
    operator_port, robot_port, direct_port, udp_port = free_ports(4)
    found: dict[str, object] = {"udp": _with_echo(f"udp:{udp_port}", count, _udp_times, udp_port)}
    endpoint = f"tcp/127.0.0.1:{direct_port}"
    session = open_session((), [endpoint])
    found["zenoh_direct"] = _with_echo(endpoint, count, _zenoh_times, session)
    near, far = f"tcp/127.0.0.1:{operator_port}", f"tcp/127.0.0.1:{robot_port}"
    proxy = start_proxy({"listen_operator": near, "listen_robot": far})
    try:
        found["zenoh_through_proxy"] = _with_echo(far, count, _zenoh_times, open_session([near]))
    finally:
        stop_proxy(proxy)
    return found


def _with_echo(where, count, measure, argument):
    process = subprocess.Popen([sys.executable, __file__, "--echo", where], stdin=subprocess.PIPE)
    try:
        times = sorted(measure(argument, count))
    finally:
        process.stdin.close()
        process.wait(10)
    return {"p50": statistics.median(times), "p99": times[int(0.99 * len(times))]}


def _udp_times(port, count):
    clock = SystemClock()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as mine:
        mine.settimeout(0.1)
        for number in range(count + 50):
            while True:
                start_ns = clock.now_ns()
                mine.sendto(number.to_bytes(4, "little") + bytes(296), ("127.0.0.1", port))
                try:
                    while int.from_bytes(mine.recv(400)[:4], "little") != number:
                        pass
                    break
                except OSError:
                    continue  # the echo is not there yet
            if number >= 50:
                yield (clock.now_ns() - start_ns) * 1e-9


def _zenoh_times(session, count):
    clock = SystemClock()
    arrived = queue.SimpleQueue()
    session.declare_subscriber(
        PONG, lambda s: arrived.put(int.from_bytes(s.payload.to_bytes()[:4], "little"))
    )
    try:
        for number in range(count + 50):
            while True:
                start_ns = clock.now_ns()
                session.put(
                    PING,
                    number.to_bytes(4, "little") + bytes(296),
                    express=True,
                    congestion_control=zenoh.CongestionControl.BLOCK,
                )
                try:
                    while arrived.get(timeout=0.3) != number:
                        pass
                    break
                except queue.Empty:
                    continue  # the echo is not there yet
            if number >= 50:
                yield (clock.now_ns() - start_ns) * 1e-9
    finally:
        session.close()


def _echo(where):
    """Answer everything until stdin is closed."""
    if where.startswith("udp:"):
        mine = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        mine.bind(("127.0.0.1", int(where[4:])))

        def answer():
            while True:
                data, address = mine.recvfrom(400)
                mine.sendto(data, address)

        threading.Thread(target=answer, daemon=True).start()
        sys.stdin.read()
        return
    session = open_session([where])
    session.declare_subscriber(
        PING,
        lambda s: session.put(
            PONG, s.payload.to_bytes(), express=True, congestion_control=zenoh.CongestionControl.BLOCK
        ),
    )
    sys.stdin.read()
    session.close()


def _print(found):
    console = Console(markup=False)
    table = Table(title="Error of the achieved delay, constant 20 ms, 500 messages/s each way (ms)")
    for column in ("scheduling", "median", "p99", "max"):
        table.add_column(column, justify="right")
    for name, values in found["error"].items():
        cells = (
            [f"{values[q] * 1e3:.3f}" for q in ("p50", "p99", "max")] if values else ["not allowed", "", ""]
        )
        table.add_row(name, *cells)
    table.add_row("Toxiproxy's own tests accept", "± 10", "", "")
    console.print(table)
    table = Table(title="Rate each way up to which p99 stays under 2 ms and every message is accounted for")
    for column in ("bytes", "messages/s", "robots at 100 Hz", "p99 by rate (ms)"):
        table.add_column(column, justify="right")
    for size, values in found["capacity"].items():
        rates = ", ".join(f"{rate}: {entry['p99'] * 1e3:.2f}" for rate, entry in values["by_rate"].items())
        table.add_row(size, str(values["messages_per_second"]), str(values["robots_at_100_hz"]), rates)
    console.print(table)
    trips = found["round_trip"]
    table = Table(title="Round trip, 300 bytes")
    for column in ("way", "median (ms)", "p99 (ms)", "median / raw UDP"):
        table.add_column(column, justify="right")
    for name, values in trips.items():
        ratio = values["p50"] / trips["udp"]["p50"]
        table.add_row(name, f"{values['p50'] * 1e3:.3f}", f"{values['p99'] * 1e3:.3f}", f"{ratio:.1f}")
    console.print(table)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", metavar="FILE")
    parser.add_argument("--quick", action="store_true", help="to see that it works; the figures mean nothing")
    parser.add_argument("--echo", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.echo:
        _echo(arguments.echo)
        return
    found = run(arguments.quick)
    _print(found)
    if arguments.json:
        Path(arguments.json).write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
