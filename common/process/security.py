"""What a program may listen on and connect to: TLS where there are certificates, else this host only."""

from collections.abc import Callable
from dataclasses import dataclass

import zenoh

from farhand.common.errors import EndpointError, InputError
from farhand.common.link.endpoints import check_endpoint, is_loopback
from farhand.common.link.presence import Presence
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Access:
    """How a program meets the others.

    Attributes:
        connect, listen: endpoints.
        tls: certificate folder; empty: none.
        insecure: whether listening beyond this host without TLS was accepted.
        router: whether what is connected to is a Zenoh router, whose client this program is.
    """

    connect: tuple[str, ...] = ()
    listen: tuple[str, ...] = ()
    tls: str = ""
    insecure: bool = False
    router: bool = False

    @property
    def mode(self) -> str:
        """The Zenoh mode of the session; raises EndpointError."""
        if self.router and self.listen:
            raise EndpointError(
                f"--listen {self.listen[0]}: a router's client only connects; leave --listen or --router out"
            )
        return "client" if self.router else "peer"

    @property
    def where(self) -> str:
        """The endpoints, for people."""
        return ", ".join([*self.connect, *self.listen])


def secure(access: Access, say: Callable[[str], None], role: str = "", robot: str = "") -> TlsFolder | None:
    """Check endpoints against what was asked for, and say what the user must know.

    Args:
        access: what was asked for.
        say: takes a line for the user.
        role, robot: what the certificate must be of and for; empty: anything.

    Returns:
        The certificate folder, or None without TLS.

    Raises:
        InputError: an endpoint does not go with the rest, or the folder cannot be used.
    """
    if access.tls and access.insecure:
        raise InputError("--tls and --insecure exclude each other; leave one out")
    for endpoint in (*access.connect, *access.listen):
        _check_protocol(endpoint, access.tls)
    if access.tls:
        folder = load_folder(access.tls, role, robot)
        for line in folder.warnings:
            say(line)
        return folder
    for endpoint in access.listen:
        if is_loopback(endpoint):
            continue
        if not access.insecure:
            raise EndpointError(
                f"endpoint {endpoint}: without TLS whoever reaches it can move the robot; "
                "use --tls DIR, or --insecure to accept that"
            )
        say(f"INSECURE: whoever reaches {endpoint} can read everything and move the robot")
    for endpoint in access.connect:
        if not is_loopback(endpoint):
            say(f"INSECURE: what goes to {endpoint} is neither encrypted nor authenticated")
    return None


def _check_protocol(endpoint: str, tls: str) -> None:
    """Raise EndpointError where an endpoint is malformed, or is secured and the program is not, or the reverse."""
    check_endpoint(endpoint)
    is_tls = endpoint.startswith("tls/")
    if tls and not is_tls:
        raise EndpointError(f"endpoint {endpoint}: with --tls it must be tls/{endpoint.partition('/')[2]}")
    if is_tls and not tls:
        raise EndpointError(f"endpoint {endpoint}: needs --tls DIR with this program's certificate")


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
    return folder.own.role if folder.own.role in ("operator", "robot", "camera", "observer") else "router"
