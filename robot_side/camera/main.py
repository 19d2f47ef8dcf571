"""The camera as a program: its node in a loop that gives way to everything else on this host."""

import os
import threading
from collections.abc import Callable

from farhand.common.timing.clock import SystemClock
from farhand.common.timing.loop import RealtimeLoop
from farhand.robot_side.camera.camera_node import CameraNode

NICENESS = 10
"""So that on a busy host pictures are late, and the robot is not."""


def run_camera(
    node: CameraNode, clock: SystemClock, stop_event: threading.Event, say: Callable[[str], None]
) -> None:
    """Run a camera's node until `stop_event` is set; says when there is no picture, and when there is again."""
    os.nice(NICENESS)
    said = ""

    def look(_now_ns: int) -> None:
        nonlocal said
        if bool(node.trouble) != bool(said):
            say(f"no picture is sent: {node.trouble}" if node.trouble else "sends pictures again")
            said = node.trouble

    loop = RealtimeLoop(node, clock, realtime=False, until=lambda _: stop_event.is_set())
    loop.after.append(look)
    loop.run()
