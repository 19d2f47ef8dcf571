"""The robot's loop: how fast each robot runs in virtual time, and how late 500 Hz is in real time.

`python benchmarks/robot_loop.py [--quick] [--json FILE]`. Run it on an idle machine.
"""

import argparse
import json
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import msgspec

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from farhand.common.link.link import Packet, memory_wire
from farhand.common.messages.base import Echo
from farhand.common.messages.codec import encode
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.keys import command_key
from farhand.common.timing.clock import SystemClock, thread_seconds
from farhand.common.timing.loop import RealtimeLoop
from farhand.robot_side.robot_node import RobotNode
from farhand.robot_side.robots.registry import make_robot
from farhand.robot_side.robots.robot import Robot
from farhand.runs.scenario import Scenario, load_scenario

SESSION = 1
RATE_HZ = 500.0
VIRTUAL_SECONDS, REAL_SECONDS = 10.0, 5.0
QUICK = 0.3, 0.2
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


def driven(scenario: Scenario, robot: Robot, seconds: float) -> Iterator[Callable[[], None]]:
    """The ticks of a robot's program, each to be called, under commands at 10 Hz.

    Raises RuntimeError where they did not drive it.
    """
    far, link = memory_wire()
    node = RobotNode(scenario, robot, link, "r", SESSION)
    now_ns, seq, next_command_ns = 0, 0, 0
    next_ns = node.step(now_ns)

    def step() -> None:
        nonlocal next_ns
        next_ns = node.step(now_ns)

    while now_ns < seconds * 1e9:
        if now_ns >= next_command_ns:
            link.deliver(Packet(command_key("r"), _command(seq, now_ns)), now_ns)
            seq, next_command_ns = seq + 1, next_command_ns + COMMAND_PERIOD_NS
        yield step
        now_ns = next_ns
        far.receive()
    summary = node.summary()
    if summary.mode != "run" or summary.refused:
        raise RuntimeError(f"the robot was not driven: {summary}")


def virtual_speed(name: str, seconds: float) -> dict[str, float]:
    """Seconds of robot per second of computing, commanded at 10 Hz, states at 100 Hz."""
    scenario = _scenario(name)
    robot = make_robot(scenario)
    ticks, spent = 0, 0.0
    for step in driven(scenario, robot, seconds):
        began = thread_seconds()
        step()
        spent += thread_seconds() - began
        ticks += 1
    robot.close()
    return {"times_real_time": seconds / spent, "tick": spent / ticks}


def lateness(realtime: bool, seconds: float) -> dict[str, Any]:
    """How late the wake-ups of the UR5's loop are in real time (s); bins are powers of two of 1 us."""
    scenario = _scenario("ur5-obstacle")
    robot = make_robot(scenario)
    _, link = memory_wire()
    node = RobotNode(scenario, robot, link, "r", SESSION)
    executor = RealtimeLoop(node, SystemClock(), realtime=realtime)
    # A thread of its own: scheduling rights are a thread's, and end with it.
    thread = threading.Thread(target=executor.run)
    thread.start()
    thread.join(seconds)
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


def run(virtual: float = VIRTUAL_SECONDS, real: float = REAL_SECONDS) -> dict[str, Any]:
    """All measurements of one run, for as many seconds of each kind."""
    results: dict[str, Any] = {"virtual": {name: virtual_speed(name, virtual) for name in SCENARIOS}}
    results["lateness"] = {"plain": lateness(False, real), "fifo": lateness(True, real)}
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
    parser.add_argument("--quick", action="store_true", help="to see that it works; the figures mean nothing")
    arguments = parser.parse_args()
    results = run(*QUICK) if arguments.quick else run()
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
