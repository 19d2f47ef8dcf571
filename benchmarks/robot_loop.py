"""The robot's loop: how fast each robot runs in virtual time, and how late 500 Hz is in real time.

`python benchmarks/robot_loop.py [--json FILE]`. Run it on an idle machine.
"""

import argparse
import json
import sys
import threading
from pathlib import Path
from typing import Any

import msgspec

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from farhand.common.link.link import Packet, memory_wire
from farhand.common.messages.base import Echo
from farhand.common.messages.codec import encode
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.keys import command_key
from farhand.common.timing.clock import SystemClock, processor_seconds
from farhand.common.timing.loop import RealtimeLoop
from farhand.robot_side.robot_node import RobotNode
from farhand.robot_side.robots.registry import make_robot
from farhand.runs.scenario import Scenario, load_scenario

SESSION = 1
RATE_HZ = 500.0
VIRTUAL_SECONDS = 10.0
REAL_SECONDS = 5.0
COMMAND_PERIOD_NS = 100_000_000
SCENARIOS = ("ur5-obstacle", "box-obstacle", "point-obstacle")


def _scenario(name: str) -> Scenario:
    scenario = load_scenario(name)
    robot = msgspec.structs.replace(scenario.robot, rate_hz=RATE_HZ, state_rate_hz=100.0)
    return msgspec.structs.replace(scenario, robot=robot)


def _command(seq: int, now_ns: int) -> bytes:
    """A fresh command with a plan of nine; back and forth, one second each way."""
    speed = 0.1 if seq // 10 % 2 == 0 else -0.1
    return encode(
        VelocityCommand(
            source="bench",
            session=2,
            seq=seq,
            t_sent_ns=now_ns,
            echo=Echo(SESSION, 0, now_ns, 0),
            mode="run",
            velocity=(0.0, speed, 0.0),
            plan=((0.0, speed, 0.0),) * 9,
        )
    )


def virtual_speed(name: str) -> dict[str, float]:
    """Seconds of robot per second of computing, commanded at 10 Hz, states at 100 Hz."""
    scenario = _scenario(name)
    robot = make_robot(scenario)
    far, link = memory_wire()
    node = RobotNode(scenario, robot, link, "r", SESSION)
    now_ns, seq, next_command_ns = 0, 0, 0
    node.step(now_ns)
    started = processor_seconds()
    while now_ns < VIRTUAL_SECONDS * 1e9:
        if now_ns >= next_command_ns:
            link.deliver(Packet(command_key("r"), _command(seq, now_ns)), now_ns)
            seq, next_command_ns = seq + 1, next_command_ns + COMMAND_PERIOD_NS
        now_ns = node.step(now_ns)
        far.receive()
    spent = processor_seconds() - started
    summary = node.summary()
    robot.close()
    if summary.mode != "run" or summary.refused:
        raise RuntimeError(f"the robot was not driven: {summary}")
    return {"times_real_time": VIRTUAL_SECONDS / spent, "tick": spent / summary.ticks}


def lateness(realtime: bool) -> dict[str, Any]:
    """How late the wake-ups of the UR5's loop are in real time (s); bins are powers of two of 1 us."""
    scenario = _scenario("ur5-obstacle")
    robot = make_robot(scenario)
    _, link = memory_wire()
    node = RobotNode(scenario, robot, link, "r", SESSION)
    executor = RealtimeLoop(node, SystemClock(), realtime=realtime)
    # A thread of its own: scheduling rights are a thread's, and end with it.
    thread = threading.Thread(target=executor.run)
    thread.start()
    thread.join(REAL_SECONDS)
    executor.stop()
    thread.join()
    robot.close()
    late = executor.lateness
    return {
        "realtime_priority": executor.has_realtime_priority,
        "wake_ups": late.count,
        "mean": late.total_ns / max(1, late.count) * 1e-9,
        "p50": late.quantile(0.5),
        "p99": late.quantile(0.99),
        "max": late.max_ns * 1e-9,
        "overruns": node.summary().overruns,
    }


def run() -> dict[str, Any]:
    """All measurements of one run."""
    results: dict[str, Any] = {"virtual": {name: virtual_speed(name) for name in SCENARIOS}}
    results["lateness"] = {"plain": lateness(False), "fifo": lateness(True)}
    point = results["virtual"]["point-obstacle"]["times_real_time"]
    results["ratios"] = {
        "ur5_virtual_to_real_time": results["virtual"]["ur5-obstacle"]["times_real_time"],
        "point_to_ur5": point / results["virtual"]["ur5-obstacle"]["times_real_time"],
        "plain_to_fifo_p99": results["lateness"]["plain"]["p99"] / results["lateness"]["fifo"]["p99"],
    }
    return results


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the results here as well")
    arguments = parser.parse_args()
    results = run()
    for name, speed in results["virtual"].items():
        print(
            f"{name:16s} {speed['times_real_time']:8.1f} x real time   {speed['tick'] * 1e6:7.1f} us a tick"
        )
    for name, late in results["lateness"].items():
        note = "" if name == "plain" or late["realtime_priority"] else "  (not permitted here)"
        print(
            f"500 Hz, {name:8s} late by mean {late['mean'] * 1e6:.0f} us, p50 <= {late['p50'] * 1e6:.0f} us, "
            f"p99 <= {late['p99'] * 1e6:.0f} us, max {late['max'] * 1e3:.2f} ms, "
            f"{late['overruns']} of {late['wake_ups']} overrun{note}"
        )
    for name, ratio in results["ratios"].items():
        print(f"{name:28s} {ratio:.1f}")
    if arguments.json is not None:
        arguments.json.write_text(json.dumps(results, indent=2), encoding="utf-8")


if __name__ == "__main__":
    main()
