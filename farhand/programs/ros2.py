"""The program `farhand ros2`: a node of a ROS 2 graph, beside an operator's program or on the robot's side."""

import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack

from farhand.bridges.ros2.bridge import Bridge, Desk
from farhand.bridges.ros2.desk import OperatorDesk, RobotDesk
from farhand.bridges.ros2.node import RosNode
from farhand.bridges.ros2.settings import Ros2Options as Ros2Options
from farhand.bridges.ros2.types import Types
from farhand.bridges.ros2.wire import check_namespace, node_name
from farhand.common.link.zenoh_link import ZenohLink, open_session
from farhand.common.messages.keys import (
    camera_key,
    check_robot_name,
    description_key,
    mirror_key,
    report_key,
    scene_key,
    state_key,
)
from farhand.common.process.security import Access, local_only, secure
from farhand.common.process.signals import PeerWatch, say, stop_event_on_signals
from farhand.common.process.teller import Teller
from farhand.common.timing.clock import SystemClock
from farhand.common.timing.loop import RealtimeLoop
from farhand.programs.sessions import random_session

SWITCH_INTERVAL = 0.0005
"""How long the thread that draws may keep the loop's from running (s)."""


def ros2_program(options: Ros2Options) -> int:
    """Run until it is told to end; returns 0. Raises InputError."""
    robot = check_robot_name(options.robot)
    types = Types(options.distro)
    connect = _connect(options)
    secure(Access(connect=(options.router,)), lambda line: say("ros2", line))
    sys.setswitchinterval(SWITCH_INTERVAL)
    stop_event, clock = stop_event_on_signals(), SystemClock()
    with ExitStack() as closing:
        teller = Teller("ros2")
        closing.callback(teller.close)
        ros = open_session([options.router], mode="client", extra=[("timestamping/enabled", True)])
        closing.callback(ros.close)
        name, namespace = node_name(robot), check_namespace(options.namespace)
        wakes: list[Callable[[], None]] = []
        node = RosNode(
            ros,
            types,
            clock,
            domain=options.domain,
            namespace=namespace,
            name=name,
            wake=lambda: _wake(wakes),
        )
        session = open_session([connect])
        link = ZenohLink(session, _keys(robot, options.side), clock, lambda: _wake(wakes))
        closing.callback(link.close)
        desk: Desk = OperatorDesk(session, robot) if options.steers else RobotDesk(robot, connect)
        bridge = Bridge(options, node, link, desk, clock, random_session, teller.say)
        loop = RealtimeLoop(
            bridge.node,
            clock,
            message_driven=True,
            realtime=options.realtime,
            until=lambda _: stop_event.is_set(),
        )
        loop.after.append(bridge.look)
        wakes.append(loop.notify)
        PeerWatch("ros2", connect, link.connected, stop_event)
        teller.say(
            f"node {namespace}/{name} of domain {options.domain} ({options.distro}) at {options.router}; "
            f"robot {robot!r} at {connect}; Ctrl-C ends it"
        )
        loop.run()
        bridge.close(clock.now_ns())
    return 0


def _wake(wakes: Sequence[Callable[[], None]]) -> None:
    for wake in wakes:
        wake()


def _connect(options: Ros2Options) -> str:
    """Where the robot is heard: an operator's reports never leave its host, a robot may be another one's."""
    if options.steers:
        return local_only(options.connect, "--connect")
    secure(Access(connect=(options.connect,)), lambda line: say("ros2", line))
    return options.connect


def _keys(robot: str, side: str) -> list[str]:
    if side == "robot":
        return [state_key(robot), scene_key(robot), description_key(robot), camera_key(robot)]
    mirrored = ("state", "scene", "description", "command", "camera")
    return [report_key(robot), *(mirror_key(robot, kind) for kind in mirrored)]
