"""The program `farhand robot`: its session, its link, the node in its loop."""

from collections.abc import Sequence
from pathlib import Path

from farhand.common.link.zenoh_link import ZenohLink, open_session
from farhand.common.messages.keys import check_robot_name, command_key
from farhand.common.process.security import guard, secure
from farhand.common.process.signals import PeerWatch, say, stop_event_on_signals
from farhand.common.process.systemd import tell_systemd
from farhand.common.process.teller import Teller
from farhand.common.timing.clock import SystemClock
from farhand.common.trust.zenoh_log import tell_refusals
from farhand.programs.sessions import session_mode
from farhand.robot_side.main import run_robot
from farhand.runs.scenario import Scenario


def robot_program(
    scenario: Scenario,
    *,
    name: str,
    connect: Sequence[str],
    listen: Sequence[str],
    result: Path | None,
    realtime: bool = True,
    tls: str = "",
    insecure: bool = False,
    router: bool = False,
) -> int:
    """Run the robot's side until it is told to end."""
    check_robot_name(name)
    mode = session_mode(router, listen)
    folder = secure(tls, insecure, connect, listen, lambda line: say("robot", line), "robot", name)
    teller = Teller("robot")
    if folder is not None:
        tell_refusals(teller.say)
    stop_event = stop_event_on_signals()
    clock = SystemClock()
    extra = folder.settings("robot") if folder else ()
    link = ZenohLink(open_session(connect, listen, mode=mode, extra=extra), [command_key(name)], clock)
    try:
        guard(link.session, folder, name, "robot", teller.say)
        where = ", ".join([*connect, *listen])
        PeerWatch("robot", where, link.connected, stop_event, troubles=link.losses)
        watched = tell_systemd(link, stop_event)
        run_robot(scenario, name, watched, clock, stop_event, result, realtime, teller.say)
    finally:
        link.close()
        teller.close()
    return 0
