"""How a command reaches a robot and its operator's program from a host of theirs, and whether it may command."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

import zenoh

from farhand.common.errors import InputError
from farhand.common.link.zenoh_link import open_session
from farhand.common.messages.keys import check_robot_name
from farhand.common.process.security import Access, local_endpoint, secure, tool_place
from farhand.common.process.signals import say
from farhand.common.trust.tls import TlsFolder
from farhand.site.operator_name import operator_name

REPORT_ENDPOINT = "tcp/127.0.0.1:7446"
_MAY_COMMAND = ("operator", "netem", "router")


@dataclass(frozen=True, slots=True)
class Reached:
    """Attributes:
    sessions: on which to ask and to listen.
    source: who asks, for the robot.
    tried: the endpoints, in words.
    """

    sessions: list[zenoh.Session]
    source: str
    tried: str


@contextmanager
def reaching(
    command: str, robot: str, connect: Sequence[str], tls: str, router: bool, *, commands: bool = True
) -> Iterator[Reached]:
    """Sessions to where a robot may be heard; closed at the end.

    Args:
        command: who asks, for lines to people.
        robot: its name.
        connect: endpoints of an operator's --report, of the robot or of the emulator; empty: those of this host.
        tls: certificate folder; empty: none.
        router: the endpoints are those of a Zenoh router.
        commands: whether more than listening is wanted.

    Raises:
        InputError: an endpoint, or the certificate's rights, do not allow it.
    """
    check_robot_name(robot)
    ends = tuple(connect) or (local_endpoint(7447, tls),)
    folder = secure(Access(connect=ends, tls=tls), lambda line: say(command, line))
    if folder is not None and commands:
        check_rights(folder, robot)
    with ExitStack() as closing:
        extra = folder.settings(tool_place(folder)) if folder else ()
        sessions = [open_session(ends, mode="client" if router else "peer", extra=extra)]
        closing.callback(sessions[0].close)
        if not connect:
            sessions.append(open_session([REPORT_ENDPOINT]))
            closing.callback(sessions[1].close)
        tried = ", ".join([*ends, *([REPORT_ENDPOINT] if not connect else [])])
        yield Reached(sessions, operator_name("", folder), tried)


def check_rights(folder: TlsFolder, robot: str) -> None:
    """Raise InputError where a certificate must not command a robot: the other end would drop it in silence."""
    own = folder.own
    if own.role not in _MAY_COMMAND:
        raise InputError(f"--tls: certificate {own.name!r} has the role {own.role}, which must not command; "
                         "take an operator's")  # fmt: skip
    if own.robots and robot not in own.robots:
        raise InputError(f"--robot {robot!r}: certificate {own.name!r} is for {', '.join(own.robots)}")
