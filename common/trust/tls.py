"""A certificate folder, and the Zenoh settings that follow from it: mutual TLS and access control.

The folder holds `ca.pem` (the authority), `cert.pem` and `key.pem` (its owner's), and `members/`: the public
certificates of those whom its owner deals with. Whoever is not in there connects but is given nothing; to
take a right away, remove the file and restart.
"""

import stat
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import zenoh
from cryptography.hazmat.primitives import serialization

from farhand.common.errors import CertificateError
from farhand.common.trust.access import access_control
from farhand.common.trust.certificate import Member, read_certificate, signed_by, today
from farhand.common.trust.expiry import ExpiryThread, ending_line

ACCEPTED = {
    "operator": ("netem", "router", "robot", "camera", "observer"),
    "robot": ("netem", "router", "operator", "camera", "observer"),
    "camera": ("netem", "router", "robot", "operator", "observer"),
    "netem-operator": ("operator", "observer", "netem", "router"),
    "netem-robot": ("robot", "camera", "observer", "netem", "router"),
    "router": ("operator", "robot", "camera", "netem", "router", "observer"),
    "observer": ("netem", "router", "robot", "camera", "operator"),
}
"""Roles that a session of a place deals with."""


@dataclass(frozen=True, slots=True)
class TlsFolder:
    """A folder, read and checked.

    Attributes:
        path: of the folder.
        authority: the certificate that all others are signed by.
        own: the certificate of its owner.
        members: valid certificates of others.
        warnings: one line each: what ends soon, what was left out and why.
    """

    path: Path
    authority: Member
    own: Member
    members: tuple[Member, ...]
    warnings: tuple[str, ...]

    def accepted(self, place: str) -> tuple[Member, ...]:
        """Those that a session of a place (a key of ACCEPTED) deals with."""
        return tuple(member for member in self.members if member.role in ACCEPTED[place])

    def watch_ends(self, say: Callable[[str], None]) -> ExpiryThread:
        """Say once a day what ends, of all certificates in the folder; to be closed."""
        return ExpiryThread(dict.fromkeys((self.own, self.authority, *self.members)), say)

    def settings(self, place: str) -> list[tuple[str, object]]:
        """The (path, value) settings of a session of a place."""
        return [*self.encryption(), ("access_control", access_control(self.own, self.accepted(place)))]

    def encryption(self) -> list[tuple[str, object]]:
        """Those of them by which each proves who it is; what may pass is not said: for keys that are not Farhand's."""
        certificate, key = str(self.path / "cert.pem"), str(self.path / "key.pem")
        tls = {
            "root_ca_certificate": str(self.path / "ca.pem"),
            "enable_mtls": True,
            "verify_name_on_connect": True,
            "close_link_on_expiration": True,
            "listen_certificate": certificate,
            "listen_private_key": key,
            "connect_certificate": certificate,
            "connect_private_key": key,
        }
        return [
            ("transport/link/protocols", ["tls"]),
            *((f"transport/link/tls/{name}", value) for name, value in tls.items()),
        ]


def load_folder(folder: str | Path, role: str = "", robot: str = "") -> TlsFolder:
    """Read a certificate folder.

    Args:
        folder: as `farhand certs issue` makes it.
        role: what its owner must be; empty: anything.
        robot: the robot that it must be named for; empty: any.

    Raises:
        CertificateError: something is missing, does not fit together, has ended, or is for another purpose.
    """
    path = Path(folder).resolve()
    for name in ("ca.pem", "cert.pem", "key.pem"):
        try:
            found = (path / name).is_file()
        except OSError as error:
            raise CertificateError(f"--tls {folder}: cannot be read: {error.strerror}") from None
        if not found:
            raise CertificateError(
                f"--tls {folder}: there is no {name}; `farhand certs issue` makes such a folder"
            )
    authority, own = read_certificate(path / "ca.pem"), read_certificate(path / "cert.pem")
    _check_own(folder, authority, own, path / "key.pem", role, robot)
    warnings = [
        line for line in (ending_line(authority), ending_line(own), _readable(path / "key.pem")) if line
    ]
    members: list[Member] = []
    for file in sorted((path / "members").glob("*.pem")):
        try:
            member = read_certificate(file)
        except CertificateError as error:
            warnings.append(f"left out: {error}")
            continue
        problem = _problem(member, authority, [*members, own])
        if problem:
            warnings.append(f"left out: {file.name}: {problem}")
        elif member.name != own.name:
            members.append(member)
            warnings += [line for line in [ending_line(member)] if line]
    return TlsFolder(path, authority, own, (*members, own), tuple(warnings))


def watch_names(
    session: zenoh.Session, folder: TlsFolder, place: str, say: Callable[[str], None]
) -> "zenoh.LinkEventsListener[None]":
    """Say who connects with a certificate that no rule has, since Zenoh silently gives it nothing.

    And say of a link that closes that a certificate has ended, if one has. `say` is called in a Zenoh
    thread. Keep what is returned for as long as it shall watch.
    """
    known = {member.name: member for member in folder.accepted(place)}

    def linked(event: zenoh.LinkEvent) -> None:
        name = event.link.auth_identifier
        if event.kind != zenoh.SampleKind.PUT:
            for member in (folder.own, known.get(name or "")):
                if member is not None and member.days_left <= 0:
                    say(f"the link to {event.link.dst} is closed: certificate {member.name!r} has ended")
                    return
        elif name not in known:
            say(
                f"refused: {event.link.dst} has certificate {name!r}, which is not in {folder.path}/members "
                "as one for this place; it is given nothing"
            )

    return session.info.declare_link_events_listener(linked, history=True)


def nested(settings: Iterable[tuple[str, object]]) -> dict[str, object]:
    """(path, value) settings as one nested dictionary, such as a configuration file of a router holds."""
    result: dict[str, object] = {}
    for path, value in settings:
        *folders, last = path.split("/")
        place = result
        for name in folders:
            place = place.setdefault(name, {})  # type: ignore[assignment]
        place[last] = value
    return result


def _check_own(folder: str | Path, authority: Member, own: Member, key: Path, role: str, robot: str) -> None:
    where = f"--tls {folder}: certificate {own.name!r}"
    if not signed_by(own, authority):
        raise CertificateError(f"{where} was not signed by the authority in ca.pem; issue it again")
    clock = f"this host's clock says {today()}"
    if own.days_left <= 0:
        raise CertificateError(
            f"{where} ended on {own.end}, and {clock}; if that is right, `farhand certs renew {own.name}` "
            "makes a new one"
        )
    if own.days_until_valid > 0:
        raise CertificateError(f"{where} is not valid before {own.begin}, and {clock}; is that right?")
    if authority.days_left <= 0:
        raise CertificateError(
            f"--tls {folder}: the authority ended on {authority.end}, and {clock}; if that is right, make a new one"
        )
    if role and own.role != role:
        raise CertificateError(f"{where} is not one of the role {role}; issue one with that role")
    if robot and robot not in own.robots:
        raise CertificateError(
            f"{where} is named for {', '.join(own.robots) or 'no robot'}, not for {robot!r}; "
            f"issue one with --robot {robot}"
        )
    try:
        private = serialization.load_pem_private_key(key.read_bytes(), None)
    except (OSError, ValueError, TypeError):
        raise CertificateError(f"--tls {folder}: key.pem is not a readable private key") from None
    form = serialization.Encoding.DER, serialization.PublicFormat.SubjectPublicKeyInfo
    if private.public_key().public_bytes(*form) != own.certificate.public_key().public_bytes(*form):
        raise CertificateError(f"--tls {folder}: key.pem does not belong to cert.pem")


def _problem(member: Member, authority: Member, seen: list[Member]) -> str:
    """Why a member's certificate gives no right, or an empty string."""
    if not signed_by(member, authority):
        return "not signed by this authority"
    if member.days_left <= 0:
        return f"ended on {member.end} (this host's clock says {today()})"
    if member.days_until_valid > 0:
        return f"is not valid before {member.begin} (this host's clock says {today()})"
    if not member.role:
        return f"its name {member.name!r} has no role"
    if any(other.name == member.name and other.certificate != member.certificate for other in seen[:-1]):
        return f"a second certificate of the name {member.name!r}"
    return ""


def _readable(key: Path) -> str:
    mode = stat.S_IMODE(key.stat().st_mode)
    return f"{key} can be read by others (mode {mode:04o}); make it 0600" if mode & 0o077 else ""
