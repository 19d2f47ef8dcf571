"""The program `farhand steer`: a device on this host, for a running operator's program that is steered from others.

The device is read in the main thread; what is wanted is sent by a loop of its own, which neither opens nor says
anything. Where the reading freezes, the loop sends zero; where the loop freezes, the operator's program holds.
"""

import threading
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from farhand.common.errors import InputError
from farhand.common.link.zenoh_link import ZenohLink, open_session
from farhand.common.messages.keys import check_robot_name, report_key
from farhand.common.process.security import local_only
from farhand.common.process.signals import PeerWatch, stop_event_on_signals
from farhand.common.process.teller import Teller
from farhand.common.scenario.section import own_settings
from farhand.common.timing.clock import SystemClock
from farhand.common.timing.loop import RealtimeLoop
from farhand.common.timing.realtime import request_realtime
from farhand.operator_side.devices.device_node import DeviceNode
from farhand.operator_side.devices.hand import Hand
from farhand.operator_side.devices.playback_node import PlaybackNode
from farhand.operator_side.devices.reading import Source
from farhand.operator_side.devices.sources import SOURCES
from farhand.operator_side.steering.hand.hand_settings import HandSettings
from farhand.operator_side.steering.hand.sender import SteeringSender
from farhand.operator_side.steering.recorded.course import read_course
from farhand.operator_side.steering.recorded.playback import Playback
from farhand.operator_side.steering.recorded.recorded import RecordedSettings
from farhand.operator_side.steering.registry import DEVICES
from farhand.programs.sessions import random_session
from farhand.runs.scenario import Scenario

READ_PERIOD = 0.005
RUMBLE_EVERY = 20
"""Readings from one rumble to the next."""

Work = Callable[[Callable[[], bool]], None]
"""What the main thread does, until what it is called with holds; that waits a little each time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SteerOptions:
    """What `farhand steer` is asked for.

    Attributes:
        robot: name of the robot.
        connect: the operator's report endpoint.
        realtime: ask for SCHED_FIFO.
    """

    robot: str
    connect: str
    realtime: bool = True


def steer_program(scenario: Scenario, options: SteerOptions) -> int:
    """Read a device until it is told to end, or play a recorded run to its end; raises InputError."""
    kind = scenario.steering.kind
    settings = own_settings(scenario.steering, DEVICES.get(kind), "steering")
    robot = check_robot_name(options.robot)
    connect = local_only(options.connect, "--connect")
    with ExitStack() as closing:
        device = _device(kind, settings, closing)
        stop_event, clock = stop_event_on_signals(), SystemClock()
        teller = Teller(kind)
        closing.callback(teller.close)
        link = ZenohLink(open_session([connect]), [report_key(robot)], clock)
        closing.callback(link.close)
        PeerWatch(kind, connect, link.connected, stop_event)
        sender = SteeringSender(robot, link, random_session(), "device", kind)
        node: DeviceNode | PlaybackNode
        if isinstance(device, Playback):
            node = PlaybackNode(device, link, sender)
            work = playing(node, teller.say)
        else:
            node = DeviceNode(Hand(settings, kind), link, sender)
            work = reading(device, node, clock, settings.rumble, teller.say)
        loop = RealtimeLoop(node, clock, realtime=options.realtime)
        sending = threading.Thread(target=loop.run, name="steering", daemon=True)
        sending.start()
        if options.realtime:
            request_realtime()  # or a busy machine lets the reading look frozen
        work(lambda: stop_event.wait(READ_PERIOD) or not sending.is_alive())
        whole = sending.is_alive()
        loop.stop()
        sending.join(1.0)
        node.leave(clock.now_ns())
    return 0 if whole else 1


def _device(kind: str, settings: object, closing: ExitStack) -> Source | Playback:
    """What is read or played; raises InputError."""
    if isinstance(settings, RecordedSettings):
        return Playback(read_course(Path(settings.run)))
    if kind not in SOURCES or not isinstance(settings, HandSettings):
        raise InputError(
            f"steer {kind!r}: no device of this host; there are {', '.join(SOURCES)}, recorded:RUN"
        )
    source = SOURCES[kind](settings.name)
    closing.callback(source.close)
    return source


def reading(
    source: Source, node: DeviceNode, clock: SystemClock, rumble: float, tell: Callable[[str], None]
) -> Work:
    """What reads a device, has said what is new, and shakes by what is not done."""

    def work(ends: Callable[[], bool]) -> None:
        said, readings, shaken = "", 0, False
        while not ends():
            node.reading = source.read(clock.now_ns())
            says = (source.trouble if node.reading is None else "") or node.says
            if says != said:
                said = says
                tell(said)
            readings += 1
            strength = rumble * node.strength
            if readings % RUMBLE_EVERY == 0 and (strength > 0.0 or shaken):
                source.rumble(strength)
                shaken = strength > 0.0

    return work


def playing(node: PlaybackNode, tell: Callable[[str], None]) -> Work:
    """What has said what is new, to the end of what is played."""

    def work(ends: Callable[[], bool]) -> None:
        said = ""
        while not ends():
            over = node.over
            if node.says != said:
                said = node.says
                tell(said)
            if over:
                return

    return work
