"""One drive of the three programs on three hosts, over the network of messages or that of the kernel."""

import math
import signal
import subprocess
from itertools import pairwise
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from farhand.common.errors import FarhandError, InputError
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.runs.run_folder import NETEM as NETEM_RESULT
from farhand.runs.run_folder import OPERATOR as OPERATOR_RESULT
from farhand.runs.run_folder import ROBOT as ROBOT_RESULT
from farhand.runs.run_folder import read_json, read_operator_result, summarise_folder, write_scenario
from farhand.runs.scenario import Scenario
from farhand.trials.hosts import NETEM_FOR_OPERATOR, NETEM_FOR_ROBOT, OPERATOR, ROBOT, Hosts
from farhand.trials.kernel.probe import Seen, probe

START_TIME = 60.0
END_TIME = 15.0
INTERVAL = 0.005
"""Between two packets of a probe (s)."""


class Drive(msgspec.Struct, frozen=True, kw_only=True):
    """What one drive showed; durations in s, NaN where nothing was seen.

    Attributes:
        spec, backend: the network, and who made it.
        packets: what single packets suffered before the drive, both directions (see Seen.summary); None: not sent.
        drawn, achieved: mean delay of a message in the emulator, both directions; None with the kernel.
        lost: fraction of what was lost, of messages (message) or packets (tc), counted by who lost it.
        rtt: round trips that the operator measured: mean and std of all, p50 and p99 of the newest at each tick.
        clearance: the least (m).
        duration: of the drive.
        refused: commands that the robot refused.
        stops: latched stops.
        safe, finished: as in `farhand demo`.
        why: what went wrong.
    """

    spec: str
    backend: str
    packets: dict[str, float] | None
    drawn: float | None
    achieved: float | None
    lost: float
    rtt: dict[str, float]
    clearance: float | None
    duration: float
    refused: int
    stops: int
    safe: bool
    finished: bool
    why: str


def drive(
    scenario: Scenario, spec: str, backend: str, folder: Path, *, seed: int, time_limit: float, packets: int
) -> Drive:
    """Drive once, on hosts made for it.

    Args:
        scenario: the task.
        spec: the network of both directions.
        backend: message or tc.
        folder: for what the programs leave.
        seed: of draws and noise.
        time_limit: for the operator (s).
        packets: to send each way before the drive, 0 for none.

    Raises:
        InputError: the emulator refuses the network.
        FarhandError: a program did not start.
    """
    clock, hosts = SystemClock(), Hosts()
    try:
        task = ["--scenario", str(write_scenario(scenario, folder)), "--robot", scenario.robot.kind]
        netem = _start_netem(hosts, clock, folder, spec, backend, seed)
        seen = _probe_both(hosts, packets) if packets else []
        near = ["--connect", f"tcp/{NETEM_FOR_ROBOT}:7448", "--result", str(folder / ROBOT_RESULT)]
        far = ["--connect", f"tcp/{NETEM_FOR_OPERATOR}:7447", "--result", str(folder / OPERATOR_RESULT)]
        far += ["--seed", str(seed), "--time-limit", str(time_limit)]
        robot = hosts.start("robot", "farhand", "robot", *task, *near, log=folder / "robot.log")
        operator = hosts.start("operator", "farhand", "operator", *task, *far, log=folder / "operator.log")
        why = _wait(operator, "operator", START_TIME + time_limit)
        for program, name in ((robot, "robot"), (netem, "netem")):
            program.send_signal(signal.SIGTERM)
            why = _wait(program, name, END_TIME) or why
    finally:
        hosts.close()
    found = summarise_folder(folder, scenario, seed=seed, uplink=spec, downlink=spec, why=why)
    statistics = read_json(folder / NETEM_RESULT)
    result = read_operator_result(folder)
    series = [row[1] for row in result.series] if result is not None else []
    trips = [new for old, new in pairwise([None, *series]) if new is not None and new != old]
    directions = [statistics.get(name, {}) for name in ("uplink", "downlink")]
    return Drive(
        spec=spec,
        backend=backend,
        packets=_mean_of([one.summary() for one in seen]) if seen else None,
        drawn=_mean_delay(directions, "drawn") if backend == "message" else None,
        achieved=_mean_delay(directions, "achieved") if backend == "message" else None,
        lost=_lost_packets(statistics) if backend == "tc" else _lost_messages(directions),
        rtt={
            "mean": _or_nan(found.rtt_mean),
            "std": _or_nan(found.rtt_std),
            "p50": float(np.percentile(trips, 50)) if len(trips) else math.nan,
            "p99": float(np.percentile(trips, 99)) if len(trips) else math.nan,
        },
        clearance=found.min_clearance,
        duration=found.duration,
        refused=found.refused,
        stops=found.stops,
        safe=found.safe,
        finished=found.finished,
        why=found.why,
    )


def _start_netem(
    hosts: Hosts, clock: SystemClock, folder: Path, spec: str, backend: str, seed: int
) -> subprocess.Popen[str]:
    ready, log = folder / "ready", folder / "netem.log"
    ready.unlink(missing_ok=True)
    words = ["--network", spec, "--seed", str(seed), "--backend", backend, "--insecure"]
    words += [
        "--listen-operator",
        f"tcp/{NETEM_FOR_OPERATOR}:7447",
        "--listen-robot",
        f"tcp/{NETEM_FOR_ROBOT}:7448",
    ]
    words += ["--stats", str(folder / NETEM_RESULT), "--ready-file", str(ready)]
    netem = hosts.start("netem", "farhand", "netem", *words, log=log)
    end_ns = clock.now_ns() + to_ns(START_TIME)
    while not ready.exists():
        if netem.poll() is not None or clock.now_ns() > end_ns:
            said = (log.read_text(errors="replace").strip().splitlines() or ["silent"])[-1]
            kind = InputError if netem.poll() == 2 else FarhandError
            raise kind(f"netem did not start: {said.removeprefix('farhand: ')}")
        clock.sleep_until(clock.now_ns() + to_ns(0.05))
    return netem


def _probe_both(hosts: Hosts, packets: int) -> list[Seen]:
    netem = hosts.namespace("netem")
    return [
        probe(netem, hosts.namespace(host), address, packets, INTERVAL)
        for host, address in (("robot", ROBOT), ("operator", OPERATOR))
    ]


def _wait(program: subprocess.Popen[str], name: str, timeout: float) -> str:
    """Wait until a program ends; what was wrong with how it ended, or an empty string."""
    try:
        code = program.wait(timeout)
    except subprocess.TimeoutExpired:
        return f"the {name} program did not end within {timeout:g} s"
    good = (0, 1) if name == "operator" else (0,)
    return "" if code in good else f"the {name} program ended with exit code {code}"


def _mean_of(found: list[dict[str, float]]) -> dict[str, float]:
    return {name: float(np.mean([each[name] for each in found])) for name in found[0]}


def _mean_delay(directions: list[dict[str, Any]], name: str) -> float:
    return float(np.mean([each.get(name, {}).get("mean", math.nan) for each in directions]))


def _lost_messages(directions: list[dict[str, Any]]) -> float:
    taken = sum(each.get("received", 0) + each.get("duplicated", 0) for each in directions)
    return sum(sum(each.get("dropped", {}).values()) for each in directions) / taken if taken else 0.0


def _lost_packets(statistics: dict[str, Any]) -> float:
    counted = statistics.get("tc", [])
    dropped, sent = sum(each["dropped"] for each in counted), sum(each["packets"] for each in counted)
    return dropped / (dropped + sent) if sent else 0.0


def _or_nan(value: float | None) -> float:
    return math.nan if value is None else value
