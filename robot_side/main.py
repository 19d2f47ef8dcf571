"""The robot's program: one node in one real-time loop, and its summary at the end."""

import secrets
import threading
from collections.abc import Callable
from pathlib import Path

import msgspec

from farhand.common.link.link import Link
from farhand.common.result_file import write_result
from farhand.common.timing.clock import SystemClock
from farhand.common.timing.loop import RealtimeLoop
from farhand.robot_side.announcer import Announcer
from farhand.robot_side.result import Lateness, RobotResult
from farhand.robot_side.robot_node import RobotNode
from farhand.robot_side.robots.registry import make_robot
from farhand.robot_side.settings import RobotScenario


def run_robot(
    scenario: RobotScenario,
    robot_name: str,
    link: Link,
    clock: SystemClock,
    stop_event: threading.Event,
    summary_file: Path | None = None,
    realtime: bool = True,
    say: Callable[[str], None] | None = None,
) -> RobotResult:
    """Run the scenario's robot until `stop_event` is set; returns its result.

    The result holds the lateness of the loop as well, and is written to `summary_file`.
    `say` takes a line for people on what happens meanwhile; it is called in the loop's thread and must
    only hand it over. Raises ScenarioError
    when the robot cannot stand at the scenario's start.
    """
    robot = make_robot(scenario)
    try:
        node = RobotNode(scenario, robot, link, robot_name, secrets.randbits(48) + 1)
        loop = RealtimeLoop(node, clock, realtime=realtime, until=lambda _: stop_event.is_set())
        if say is not None:
            loop.after.append(Announcer(say, node.watchdog, node.intake).look)
        loop.run()
        late = loop.lateness
        lateness = Lateness(
            p50=late.quantile(0.5),
            p99=late.quantile(0.99),
            max=late.max_ns * 1e-9,
            realtime_priority=loop.has_realtime_priority,
        )
        result = msgspec.structs.replace(node.summary(), lateness=lateness)
    finally:
        robot.close()
    if summary_file is not None:
        write_result(result, summary_file)
    return result
