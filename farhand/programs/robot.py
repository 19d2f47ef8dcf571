"""The program `farhand robot`: its session, its link, the node in its loop."""

from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from farhand.common.link.zenoh_link import ZenohLink, open_session
from farhand.common.messages.keys import check_robot_name, command_key, scene_request_key
from farhand.common.process.outputs import survive
from farhand.common.process.security import Access, guard, secure
from farhand.common.process.signals import PeerWatch, say, stop_event_on_signals
from farhand.common.process.systemd import tell_systemd
from farhand.common.process.teller import Teller
from farhand.common.result_file import write_result
from farhand.common.shapes import hull
from farhand.common.timing.clock import SystemClock
from farhand.common.trust.zenoh_log import tell_refusals
from farhand.programs.compiling import prepare_robot_aloud
from farhand.programs.sessions import random_session
from farhand.robot_side.main import run_robot
from farhand.robot_side.robot_node import RobotNode
from farhand.robot_side.robots.registry import make_robot
from farhand.robot_side.robots.robot import Robot
from farhand.runs.scenario import Scenario, replace_setting


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotOptions:
    """What `farhand robot` is asked for beside the scenario and how it meets the others.

    Attributes:
        robot: its name, part of the keys.
        result: JSON file for what happened; None: none.
        realtime: ask for SCHED_FIFO.
    """

    robot: str
    result: Path | None = None
    realtime: bool = True


def robot_program(scenario: Scenario, access: Access, options: RobotOptions) -> int:
    """Run the robot's side until it is told to end.

    Raises InputError for what cannot be used, ScenarioError where the robot cannot stand at the start.
    """
    name = check_robot_name(options.robot)
    mode = access.mode
    folder = secure(access, lambda line: say("robot", line), "robot", name)
    stop_event, clock = stop_event_on_signals(), SystemClock()
    with ExitStack() as closing:
        teller = Teller("robot")
        closing.callback(teller.close)
        if folder is not None:
            tell_refusals(teller.say)
        extra = folder.settings("robot") if folder else ()
        prepare_robot_aloud(scenario, teller.say)  # before anything is connected
        hull.prepare()
        session = open_session(access.connect, access.listen, mode=mode, extra=extra)
        link = ZenohLink(session, [command_key(name), scene_request_key(name)], clock)
        closing.callback(link.close)
        guard(session, folder, name, "robot", teller.say)
        PeerWatch("robot", access.where, link.connected, stop_event, troubles=link.losses)
        robot = make_robot(scenario)
        closing.callback(_close, robot)
        for line in robot.notes:
            teller.say(line)
        if robot.rate_hz is not None:
            scenario = replace_setting(scenario, "robot.rate_hz", robot.rate_hz)
        teller.say(f"{name!r}, a {scenario.robot.kind}, at {access.where}; Ctrl-C ends it")
        node = RobotNode(scenario, robot, tell_systemd(link, stop_event), name, random_session())
        result = run_robot(node, clock, stop_event, realtime=options.realtime, say=teller.say)
    nearest = "" if result.min_clearance is None else f", {result.min_clearance * 1e3:.1f} mm at the nearest"
    refused = sum(result.refused.values())
    say("robot", f"ended in {result.mode}{nearest}, {refused} commands refused")
    if options.result is not None:
        path = options.result
        survive(f"--result {path}", lambda: write_result(result, path), lambda line: say("robot", line))
    return 0


def _close(robot: Robot) -> None:
    """Give the robot back; what a driver gets wrong there must not cost the result."""
    try:
        robot.close()
    except Exception as error:
        say("robot", f"could not be closed: {type(error).__name__}: {error}")
