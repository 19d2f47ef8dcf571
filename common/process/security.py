"""What a program may listen on and connect to: TLS where there are certificates, else this host only."""

from collections.abc import Callable, Sequence

import zenoh

from farhand.common.errors import EndpointError, InputError
from farhand.common.link.presence import Presence
from farhand.common.link.zenoh_link import check_endpoint, is_loopback
from farhand.common.trust.tls import TlsFolder, load_folder, watch_names


def local_endpoint(port: int, tls: str) -> str:
    """The default endpoint of a program, with or without TLS."""
    return f"{'tls' if tls else 'tcp'}/127.0.0.1:{port}"


def local_only(endpoint: str, option: str) -> str:
    """The endpoint if only this host can reach it; raises EndpointError otherwise."""
    check_endpoint(endpoint)
    if not is_loopback(endpoint):
        raise EndpointError(f"{option} {endpoint}: must be on this host, such as tcp/127.0.0.1:7446")
    return endpoint


def secure(
    tls: str,
    insecure: bool,
    connect: Sequence[str],
    listen: Sequence[str],
    say: Callable[[str], None],
    role: str = "",
    robot: str = "",
) -> TlsFolder | None:
    """Check endpoints against what was asked for, and say what the user must know.

    Args:
        tls: certificate folder; empty: none.
        insecure: whether listening beyond this host without TLS was accepted.
        connect, listen: endpoints.
        say: takes a line for the user.
        role, robot: what the certificate must be of and for; empty: anything.

    Returns:
        The certificate folder, or None without TLS.

    Raises:
        InputError: an endpoint does not go with the rest, or the folder cannot be used.
    """
    if tls and insecure:
        raise InputError("--tls and --insecure exclude each other; leave one out")
    for endpoint in (*connect, *listen):
        check_endpoint(endpoint)
        is_tls = endpoint.startswith("tls/")
        if tls and not is_tls:
            raise EndpointError(
                f"endpoint {endpoint}: with --tls it must be tls/{endpoint.partition('/')[2]}"
            )
        if is_tls and not tls:
            raise EndpointError(f"endpoint {endpoint}: needs --tls DIR with this program's certificate")
    if tls:
        folder = load_folder(tls, role, robot)
        for line in folder.warnings:
            say(line)
        return folder
    for endpoint in listen:
        if is_loopback(endpoint):
            continue
        if not insecure:
            raise EndpointError(
                f"endpoint {endpoint}: without TLS whoever reaches it can move the robot; "
                "use --tls DIR, or --insecure to accept that"
            )
        say(f"INSECURE: whoever reaches {endpoint} can read everything and move the robot")
    for endpoint in connect:
        if not is_loopback(endpoint):
            say(f"INSECURE: what goes to {endpoint} is neither encrypted nor authenticated")
    return None


_kept: list[object] = []
"""What must live as long as the process."""


def guard(
    session: zenoh.Session, folder: TlsFolder | None, robot: str, role: str, say: Callable[[str], None]
) -> None:
    """Show that a program is there, and say who connects to it without any right, and which certificate ends."""
    _kept.append(Presence(session, robot, role, folder.own if folder else None))
    if folder is not None:
        _kept.append(watch_names(session, folder, role, say))
        _kept.append(folder.watch_ends(say))


def tool_place(folder: TlsFolder) -> str:
    """The place of a tool's session, which uses the certificate of the program beside it."""
    return folder.own.role if folder.own.role in ("operator", "robot", "observer") else "router"
