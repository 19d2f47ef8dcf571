"""The program `farhand ros2`: a node of a ROS 2 graph, beside an operator's program or on the robot's side."""

import sys
import threading
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path

import zenoh

from farhand.bridges.ros2.bridge import Bridge, Desk
from farhand.bridges.ros2.cdr.types import Types
from farhand.bridges.ros2.graph.node import RosNode, namesakes
from farhand.bridges.ros2.graph.wire import SENSOR, check_namespace, node_name
from farhand.bridges.ros2.outbound.outward import Outward
from farhand.bridges.ros2.playback import CLOCK, RunPlayback
from farhand.bridges.ros2.serving.desk import OperatorDesk, RobotDesk
from farhand.bridges.ros2.settings import Ros2Options as Ros2Options
from farhand.common.link.zenoh_link import ZenohLink, open_session
from farhand.common.link.zenoh_threads import one_thread, resident
from farhand.common.messages.keys import (
    camera_key,
    check_robot_name,
    description_key,
    mirror_key,
    report_key,
    scene_key,
    state_key,
)
from farhand.common.process.security import Access, local_only, secure, tool_place
from farhand.common.process.signals import PeerWatch, say, stop_event_on_signals
from farhand.common.process.teller import Teller
from farhand.common.recording.place import recording_at
from farhand.common.recording.reader import read_run
from farhand.common.timing.clock import SystemClock
from farhand.common.timing.loop import RealtimeLoop
from farhand.common.trust.tls import TlsFolder
from farhand.programs.sessions import random_session

SWITCH_INTERVAL = 0.0005
"""How long the thread that draws may keep the loop's from running (s)."""
SETTINGS = (
    ("timestamping/enabled", True),
    ("transport/link/tx/queue/congestion_control/drop/wait_before_drop", 0),
)
"""Of the session at the router: what latched topics want, and that the one thread waits for no reader."""


def ros2_program(options: Ros2Options) -> int:
    """Run until it is told to end; returns 0. Raises InputError."""
    types = Types(options.distro)
    sys.setswitchinterval(SWITCH_INTERVAL)
    stop_event, clock = stop_event_on_signals(), SystemClock()
    with ExitStack() as closing:
        teller = Teller("ros2")
        closing.callback(teller.close)
        if options.run is not None:
            _play(options.run, options, types, clock, stop_event, closing)
        else:
            _bridge(options, types, clock, stop_event, closing, teller.say)
    return 0


def _bridge(
    options: Ros2Options,
    types: Types,
    clock: SystemClock,
    stop_event: threading.Event,
    closing: ExitStack,
    tell: Callable[[str], None],
) -> None:
    """A running robot, until `stop_event` is set."""
    robot = check_robot_name(options.robot)
    folder = _connected(options)
    connect = options.connect
    wakes: list[Callable[[], None]] = []
    node = _node(robot, options, types, clock, closing, lambda: _wake(wakes))
    session = open_session([connect], extra=folder.settings(tool_place(folder)) if folder else ())
    # What arrives there wakes nobody: it waits for the next look, and states for nothing.
    link = ZenohLink(session, _keys(robot, options.side), clock, direct=True)
    closing.callback(link.close)
    desk: Desk = (
        OperatorDesk(session, robot) if options.steers else RobotDesk(robot, connect, options.tls_of(connect))
    )
    bridge = Bridge(options, node, link, desk, clock, random_session, tell)
    states = _states(session, robot, options, bridge.outward, clock)
    closing.callback(states.undeclare)
    loop = RealtimeLoop(
        bridge.node,
        clock,
        message_driven=True,
        realtime=options.realtime,
        until=lambda _: stop_event.is_set(),
    )
    loop.after.append(bridge.look)
    wakes.append(loop.notify)
    PeerWatch("ros2", connect, link.connected, stop_event, lambda: _heard(bridge, options),
              f"connected, but nothing is heard of a robot {robot!r}: is it another one's name?")  # fmt: skip
    tell(f"{_where(node, options)}; robot {robot!r} at {connect}; Ctrl-C ends it")
    loop.run()
    bridge.close(clock.now_ns())


def _play(
    run: Path,
    options: Ros2Options,
    types: Types,
    clock: SystemClock,
    stop_event: threading.Event,
    closing: ExitStack,
) -> None:
    """A recorded run to its end, or until `stop_event` is set."""
    found = read_run(recording_at(run))
    node = _node(check_robot_name(found.info.robot), options, types, clock, closing, lambda: None)
    outward = Outward(node, found.info.robot, found.info.epoch_ns, lambda: found.info.kept)
    closing.callback(outward.close)
    ticking = node.publisher("/clock", CLOCK, SENSOR)
    playback = RunPlayback(iter(found.ticks), found.info, outward, ticking, types, options.speed)
    say("ros2", f"{_where(node, options)}; plays {run}, {options.speed:g} times as fast; Ctrl-C ends it")
    over = RealtimeLoop(playback, clock, realtime=False, until=lambda _: stop_event.is_set() or playback.over)
    over.run()


def _node(
    robot: str,
    options: Ros2Options,
    types: Types,
    clock: SystemClock,
    closing: ExitStack,
    wake: Callable[[], None],
) -> RosNode:
    """The node at its router, until `closing`; raises InputError where there is no router."""
    folder = _secured(options.router, options)
    if folder is not None:
        closing.callback(folder.watch_ends(lambda line: say("ros2", line)).close)
    one_thread()
    # Whose keys pass there is the router's to say: access control as Farhand's own links have it knows no ROS.
    extra = [*SETTINGS, *(folder.encryption() if folder else ())]
    ros = open_session([options.router], mode="client", extra=extra)
    closing.callback(ros.close)
    name, namespace = node_name(robot), check_namespace(options.namespace)
    if namesakes(ros, options.domain, namespace, name):
        say("ros2", f"WARNING: the graph has a node {namespace}/{name} already: each tells the same topics, and either "
            "may steer; --namespace /NAME gives this one another")  # fmt: skip
    return RosNode(ros, types, clock, domain=options.domain, namespace=namespace, name=name, wake=wake)


def _where(node: RosNode, options: Ros2Options) -> str:
    return f"node {node.namespace}/{node.name} of domain {node.domain} ({options.distro}) at {options.router}"


def _states(
    session: zenoh.Session, robot: str, options: Ros2Options, outward: Outward, clock: SystemClock
) -> "zenoh.Subscriber[None]":
    """Hand states on where they arrive, in Zenoh's thread: there may be five hundred a second."""

    def take(sample: zenoh.Sample) -> None:
        outward.take_state(
            sample.payload.to_bytes(), clock.now_ns()
        )  # of a deletion: none, which are no state

    key = mirror_key(robot, "state") if options.steers else state_key(robot)
    return session.declare_subscriber(key, zenoh.handlers.Callback(resident(take), indirect=False))


def _heard(bridge: Bridge, options: Ros2Options) -> bool:
    return bridge.node.hearing.report is not None if options.steers else bridge.outward.heard


def _wake(wakes: Sequence[Callable[[], None]]) -> None:
    for wake in wakes:
        wake()


def _connected(options: Ros2Options) -> TlsFolder | None:
    """The certificate folder for where the robot is heard: an operator's reports never leave its host."""
    if options.steers:
        local_only(options.connect, "--connect")
    return _secured(options.connect, options)


def _secured(endpoint: str, options: Ros2Options) -> TlsFolder | None:
    access = Access(connect=(endpoint,), tls=options.tls_of(endpoint))
    return secure(access, lambda line: say("ros2", line))


def _keys(robot: str, side: str) -> list[str]:
    if side == "robot":
        return [scene_key(robot), description_key(robot), camera_key(robot)]
    mirrored = ("scene", "description", "command", "camera")
    return [report_key(robot), *(mirror_key(robot, kind) for kind in mirrored)]
