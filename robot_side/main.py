"""The robot's side as a program: the node in its real-time loop, and what happened at the end."""

import threading
from collections.abc import Callable

import msgspec

from farhand.common.timing.clock import SystemClock
from farhand.common.timing.loop import RealtimeLoop
from farhand.robot_side.announcer import Announcer
from farhand.robot_side.result import Lateness, RobotResult
from farhand.robot_side.robot_node import RobotNode


def run_robot(
    node: RobotNode,
    clock: SystemClock,
    stop_event: threading.Event,
    *,
    realtime: bool = True,
    say: Callable[[str], None] | None = None,
) -> RobotResult:
    """Run a robot's node until `stop_event` is set; returns its result, the lateness of the loop with it.

    Args:
        node: the node, its robot made.
        clock: of this process.
        stop_event: ends it.
        realtime: ask for SCHED_FIFO.
        say: takes a line for people on what happens meanwhile; it is called in the loop's thread and must
            only hand it over.
    """
    loop = RealtimeLoop(node, clock, realtime=realtime, until=lambda _: stop_event.is_set())
    if say is not None:
        loop.after.append(Announcer(say, node.watchdog, node.intake, node.scene_intake).look)
    loop.run()
    late = loop.lateness
    lateness = Lateness(
        p50=late.quantile(0.5),
        p99=late.quantile(0.99),
        max=late.max_ns * 1e-9,
        realtime_priority=loop.has_realtime_priority,
    )
    return msgspec.structs.replace(node.summary(), lateness=lateness)
