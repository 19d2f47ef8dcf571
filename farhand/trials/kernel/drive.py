"""One drive of the three programs on three hosts, over the network of messages or that of the kernel."""

import math
import signal
import subprocess
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import msgspec
import numpy as np

from farhand.common.errors import FarhandError, InputError
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.netem.measure.result import FlowCounts, KernelCounts, NetemResult
from farhand.operator_side.accounts.result import Sample
from farhand.programs.command_line import NetemWords, OperatorWords, RobotWords
from farhand.runs import files
from farhand.runs.results import RunResults, read_results
from farhand.runs.run import Run
from farhand.runs.run_folder import summarise_results, write_scenario
from farhand.runs.summary import RunSummary
from farhand.trials.hosts import NETEM_FOR_OPERATOR, NETEM_FOR_ROBOT, OPERATOR, ROBOT, Hosts
from farhand.trials.kernel.probe import PacketsSeen, probe

START_TIME = 60.0
END_TIME = 15.0
INTERVAL = 0.005
"""Between two packets of a probe (s)."""


class Drive(msgspec.Struct, frozen=True, kw_only=True):
    """What one drive showed; durations in s, NaN where nothing was seen.

    Attributes:
        spec, backend: the network, and who made it.
        packets: what single packets suffered before the drive, both directions, see PacketsSeen; None: not sent.
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


def drive(run: Run, backend: str, folder: Path, *, packets: int) -> Drive:
    """Drive once, on hosts made for it.

    Args:
        run: what to do, over which network.
        backend: message or tc.
        folder: for what the programs leave.
        packets: to send each way before the drive, 0 for none.

    Raises:
        InputError: the emulator refuses the network.
        FarhandError: a program did not start.
    """
    clock, hosts = SystemClock(), Hosts()
    try:
        scenario, name = str(write_scenario(run, folder)), run.scenario.robot.kind
        netem = _start_netem(hosts, clock, folder, run, backend)
        seen = _probe_both(hosts, packets) if packets else []
        near = RobotWords(
            scenario=scenario,
            robot=name,
            connect=(f"tcp/{NETEM_FOR_ROBOT}:7448",),
            result=str(folder / files.ROBOT),
        )
        far = OperatorWords(
            scenario=scenario,
            robot=name,
            connect=(f"tcp/{NETEM_FOR_OPERATOR}:7447",),
            result=str(folder / files.OPERATOR),
            seed=run.seed,
            time_limit=run.time_limit,
        )
        robot = hosts.start("robot", "farhand", *near.words(), log=folder / "robot.log")
        operator = hosts.start("operator", "farhand", *far.words(), log=folder / "operator.log")
        why = _wait(operator, "operator", START_TIME + run.time_limit)
        for program, called in ((robot, "robot"), (netem, "netem")):
            program.send_signal(signal.SIGTERM)
            why = _wait(program, called, END_TIME) or why
    finally:
        hosts.close()
    results = read_results(folder)
    packets_seen = _mean_of([one.summary() for one in seen]) if seen else None
    return _drive(run, backend, packets_seen, results, summarise_results(run, results, why))


def _drive(
    run: Run, backend: str, packets: dict[str, float] | None, results: RunResults, found: RunSummary
) -> Drive:
    netem = results.netem if results.netem is not None else NetemResult()
    ways = (netem.uplink, netem.downlink) if results.netem is not None and backend == "message" else ()
    return Drive(
        spec=str(run.network),
        backend=backend,
        packets=packets,
        drawn=_mean([way.drawn.mean for way in ways]) if backend == "message" else None,
        achieved=_mean([way.achieved.mean for way in ways]) if backend == "message" else None,
        lost=_lost_packets(netem.tc) if backend == "tc" else _lost_messages(ways),
        rtt=_round_trips(found, results.operator.series if results.operator is not None else []),
        clearance=found.min_clearance,
        duration=found.duration,
        refused=found.refused,
        stops=found.stops,
        safe=found.safe,
        finished=found.finished,
        why=found.why,
    )


def _round_trips(found: RunSummary, series: Sequence[Sample]) -> dict[str, float]:
    """What the operator measured (s): mean and std of all, quantiles of the newest at each tick."""
    newest = [trip for _, trip, *_ in series]
    trips = [new for old, new in pairwise([None, *newest]) if new is not None and new != old]
    return {
        "mean": _or_nan(found.rtt_mean),
        "std": _or_nan(found.rtt_std),
        "p50": float(np.percentile(trips, 50)) if trips else math.nan,
        "p99": float(np.percentile(trips, 99)) if trips else math.nan,
    }


def _start_netem(
    hosts: Hosts, clock: SystemClock, folder: Path, run: Run, backend: str
) -> subprocess.Popen[str]:
    ready, log = folder / "ready", folder / "netem.log"
    ready.unlink(missing_ok=True)
    words = NetemWords(
        uplink=run.network.uplink.text,
        downlink=run.network.downlink.text,
        seed=run.seed,
        backend=backend,
        insecure=True,
        listen_operator=f"tcp/{NETEM_FOR_OPERATOR}:7447",
        listen_robot=f"tcp/{NETEM_FOR_ROBOT}:7448",
        stats=str(folder / files.NETEM),
        ready_file=str(ready),
    )
    netem = hosts.start("netem", "farhand", *words.words(), log=log)
    end_ns = clock.now_ns() + to_ns(START_TIME)
    while not ready.exists():
        if netem.poll() is not None or clock.now_ns() > end_ns:
            said = (log.read_text(errors="replace").strip().splitlines() or ["silent"])[-1]
            kind = InputError if netem.poll() == 2 else FarhandError
            raise kind(f"netem did not start: {said.removeprefix('farhand: ')}")
        clock.sleep_until(clock.now_ns() + to_ns(0.05))
    return netem


def _probe_both(hosts: Hosts, packets: int) -> list[PacketsSeen]:
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


def _mean(values: Sequence[float]) -> float:
    return float(np.mean(values)) if values else math.nan


def _lost_messages(ways: Sequence[FlowCounts]) -> float:
    taken = sum(way.received + way.duplicated for way in ways)
    return sum(sum(way.dropped.values()) for way in ways) / taken if taken else 0.0


def _lost_packets(counted: Sequence[KernelCounts]) -> float:
    dropped, sent = sum(each.dropped for each in counted), sum(each.packets for each in counted)
    return dropped / (dropped + sent) if sent else 0.0


def _or_nan(value: float | None) -> float:
    return math.nan if value is None else value
