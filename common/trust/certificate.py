"""What a certificate of Farhand says: its name is ROLE.NAME, and it lists robots and hosts.

The robots are URIs among the subject's alternative names (`farhand:robot:ur5`), so that who may steer what
is signed by the authority and not a file that anybody edits.
"""

import ipaddress
import re
from dataclasses import dataclass
from pathlib import Path

from cryptography import x509
from cryptography.x509.oid import NameOID

from farhand.common.errors import CertificateError
from farhand.common.timing.clock import utc_after, utc_seconds

ROLES = ("operator", "robot", "camera", "netem", "router", "observer")
ROBOT_URI = "farhand:robot:"
WARN_DAYS = 30.0
_DAY = 86_400.0
_DNS_NAME = re.compile(
    r"(?=.{1,253}\Z)[A-Za-z0-9_]([A-Za-z0-9_-]{0,62})(\.[A-Za-z0-9_][A-Za-z0-9_-]{0,62})*\Z"
)


@dataclass(frozen=True, slots=True)
class Member:
    """One certificate, read.

    Attributes:
        name: its common name, ROLE.NAME; unique.
        role: one of ROLES, or empty where the name has none of them.
        robots: the robots it is named for; a robot's is itself.
        hosts: names and addresses at which its owner may listen.
        certificate: as read.
    """

    name: str
    role: str
    robots: tuple[str, ...]
    hosts: tuple[str, ...]
    certificate: x509.Certificate

    @property
    def days_left(self) -> float:
        """Until the end of its validity; negative after it."""
        return self.days_left_at(utc_seconds())

    def days_left_at(self, utc: float) -> float:
        """The same at a wall-clock time (s since 1970)."""
        return (self.certificate.not_valid_after_utc.timestamp() - utc) / _DAY

    @property
    def days_until_valid(self) -> float:
        """Until the beginning of its validity; negative after it."""
        return (self.certificate.not_valid_before_utc.timestamp() - utc_seconds()) / _DAY

    @property
    def begin(self) -> str:
        """The day on which its validity begins."""
        return self.certificate.not_valid_before_utc.strftime("%Y-%m-%d")

    @property
    def end(self) -> str:
        """The day on which its validity ends."""
        return self.certificate.not_valid_after_utc.strftime("%Y-%m-%d")


def read_certificate(path: Path) -> Member:
    """The certificate in a PEM file; raises CertificateError."""
    try:
        certificate = x509.load_pem_x509_certificate(path.read_bytes())
    except OSError as error:
        raise CertificateError(f"{path}: cannot be read: {error.strerror}") from None
    except ValueError:
        raise CertificateError(f"{path}: is not a certificate in PEM form") from None
    return describe(certificate)


def describe(certificate: x509.Certificate) -> Member:
    """What a certificate says."""
    names = certificate.subject.get_attributes_for_oid(NameOID.COMMON_NAME)
    name = str(names[0].value) if names else ""
    robots: list[str] = []
    hosts: list[str] = []
    try:
        others = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    except x509.ExtensionNotFound:
        others = x509.SubjectAlternativeName([])
    for other in others:
        if isinstance(other, x509.UniformResourceIdentifier) and other.value.startswith(ROBOT_URI):
            robots.append(other.value[len(ROBOT_URI) :])
        elif isinstance(other, x509.DNSName):
            hosts.append(other.value)
        elif isinstance(other, x509.IPAddress):
            hosts.append(str(other.value))
    role = name.partition(".")[0]
    return Member(
        name,
        role if role in ROLES else "",
        tuple(robots),
        tuple(hosts),
        certificate,
    )


def signed_by(member: Member, authority: Member) -> bool:
    """Whether the authority signed the certificate."""
    try:
        member.certificate.verify_directly_issued_by(authority.certificate)
    except Exception:  # several kinds, all of which mean no
        return False
    return True


def host_name(host: str) -> x509.GeneralName:
    """A host as an alternative name: an address or a DNS name; raises CertificateError."""
    try:
        return x509.IPAddress(ipaddress.ip_address(host))
    except ValueError:
        pass
    if not _DNS_NAME.match(host):
        raise CertificateError(f"--host {host!r}: must be an address or a host's name, without a port")
    return x509.DNSName(host)


def today() -> str:
    """The day that this host's clock shows, in UTC."""
    return utc_after().strftime("%Y-%m-%d")
