"""A small private certificate authority in a folder: its own files, and a folder for each member."""

import fcntl
import math
import os
import re
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from farhand.common.errors import CertificateError, InputError
from farhand.common.messages.keys import check_robot_name
from farhand.common.timing.clock import utc_after
from farhand.common.trust.certificate import ROBOT_URI, ROLES, Member, host_name, read_certificate, today

_NAME = re.compile(r"[A-Za-z0-9_.-]{1,32}\Z")
LOCAL_HOSTS = ("localhost", "127.0.0.1", "::1")
MAX_DAYS = 36_500.0
CLOCK_DIFFERENCE_DAYS = 1.0 / 24.0
"""A new certificate is valid from an hour ago, for hosts whose clock is behind."""


@contextmanager
def exclusive(folder: Path, create: bool = False) -> Iterator[None]:
    """Hold an authority's folder, so that two commands at a time come one after the other.

    Args:
        folder: of the authority.
        create: make it where there is none.

    Raises:
        CertificateError: also for whatever the operating system refuses in the meantime.
    """
    try:
        with ExitStack() as closing:
            if create and not folder.exists():
                folder.mkdir(parents=True, mode=0o700, exist_ok=True)
            if folder.is_dir():
                descriptor = os.open(folder, os.O_RDONLY)
                closing.callback(os.close, descriptor)
                fcntl.flock(descriptor, fcntl.LOCK_EX)
            yield
    except OSError as error:
        where = error.filename or folder
        raise CertificateError(f"{where}: cannot be used: {(error.strerror or str(error)).lower()}") from None


def make_authority(
    folder: Path, name: str = "Farhand CA", days: float = 3650.0, force: bool = False
) -> Member:
    """Make an authority; raises CertificateError where there is one and not `force`."""
    if (folder / "ca-key.pem").exists() and not force:
        raise CertificateError(
            f"{folder}: there is an authority already; --force makes a new one, which no old certificate is of"
        )
    check_days(days)
    if not 0 < len(name) <= 64 or not name.isprintable():
        raise InputError(f"--name {name!r}: must be 1 to 64 printable characters")
    folder.mkdir(parents=True, mode=0o700, exist_ok=True)
    key = ec.generate_private_key(ec.SECP256R1())
    subject = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)])
    usage = _usage(key_cert_sign=True)
    builder = _builder(subject, subject, key, days)
    builder = builder.add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
    builder = builder.add_extension(usage, critical=True)
    _write(folder / "ca-key.pem", _private(key), secret=True)
    _write(folder / "ca.pem", builder.sign(key, hashes.SHA256()).public_bytes(serialization.Encoding.PEM))
    return read_certificate(folder / "ca.pem")


def issue(
    folder: Path,
    role: str,
    name: str,
    robots: Sequence[str] = (),
    hosts: Sequence[str] = (),
    days: float = 365.0,
    force: bool = False,
) -> Path:
    """Make a member's folder, and put its certificate into the `members` of all; returns the folder.

    Args:
        folder: of the authority.
        role: one of ROLES.
        name: of the member among those of its role; a robot's is the robot's name.
        robots: that an operator may steer, a camera show, or an observer see; a robot has itself.
        hosts: names and addresses at which it listens; this host's own are always among them.
        days: how long it is valid; the authority's own end cuts it.
        force: replace what is there.

    Raises:
        InputError: a name is not possible, something is there already, or there is no authority.
    """
    if role not in ROLES:
        raise InputError(f"role {role!r}: must be one of {', '.join(ROLES)}")
    if not _NAME.match(name):
        raise InputError(f"name {name!r}: must be 1 to 32 letters, digits, dots, dashes or underscores")
    check_days(days)
    if role == "robot":
        check_robot_name(name)
        robots = (name,)
    elif role in ("operator", "camera", "observer") and not robots:
        raise InputError(f"{role} {name}: say for which robot: --robot NAME, repeatable")
    elif role in ("netem", "router") and robots:
        raise InputError(f"{role} {name}: forwards for all robots; leave --robot out")
    for robot in robots:
        check_robot_name(robot)
    full_name = f"{role}.{name}"
    target = folder / full_name
    if (target / "key.pem").exists() and not force:
        raise CertificateError(f"{target}: is there already; --force or `farhand certs renew` replaces it")
    authority, signer = _authority(folder)
    if authority.days_left <= 0:
        raise CertificateError(
            f"{folder}: the authority ended on {authority.end}, and this host's clock says {today()}; "
            "if that is right, make a new one"
        )
    days = min(days, authority.days_left)
    key = ec.generate_private_key(ec.SECP256R1())
    subject = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, full_name)])
    others: list[x509.GeneralName] = [host_name(host) for host in dict.fromkeys((*hosts, *LOCAL_HOSTS))]
    others += [x509.UniformResourceIdentifier(ROBOT_URI + robot) for robot in dict.fromkeys(robots)]
    purposes = [ExtendedKeyUsageOID.SERVER_AUTH, ExtendedKeyUsageOID.CLIENT_AUTH]
    builder = _builder(subject, authority.certificate.subject, key, days)
    builder = builder.add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
    builder = builder.add_extension(_usage(digital_signature=True), critical=True)
    builder = builder.add_extension(x509.ExtendedKeyUsage(purposes), critical=False)
    builder = builder.add_extension(x509.SubjectAlternativeName(others), critical=False)
    certificate = builder.sign(signer, hashes.SHA256()).public_bytes(serialization.Encoding.PEM)
    target.mkdir(mode=0o700, exist_ok=True)
    target.chmod(0o700)
    _write(target / "key.pem", _private(key), secret=True)
    _write(target / "cert.pem", certificate)
    distribute(folder)
    return target


def renew(folder: Path, full_name: str, days: float = 365.0) -> Path:
    """A new key and certificate with the same name, robots and hosts; returns the member's folder."""
    path = folder / full_name / "cert.pem"
    if full_name != Path(full_name).name or not path.is_file():
        known = ", ".join(member.name for member in members(folder)) or "none"
        raise CertificateError(f"{folder}: no certificate is called {full_name!r}; there are: {known}")
    old = read_certificate(path)
    return issue(folder, old.role, full_name.partition(".")[2], old.robots, old.hosts, days, force=True)


def members(folder: Path) -> list[Member]:
    """All certificates that an authority's folder holds, or those that a member's folder holds."""
    if (folder / "cert.pem").is_file():
        own = read_certificate(folder / "cert.pem")
        others = [read_certificate(path) for path in sorted((folder / "members").glob("*.pem"))]
        return [own, *(other for other in others if other.name != own.name)]
    return [read_certificate(path) for path in sorted(folder.glob("*/cert.pem"))]


def distribute(folder: Path) -> None:
    """Put the authority's and everybody's public certificate into every member's folder."""
    public = {path.parent.name: path.read_bytes() for path in sorted(folder.glob("*/cert.pem"))}
    authority = (folder / "ca.pem").read_bytes()
    for name in public:
        _write(folder / name / "ca.pem", authority)
        place = folder / name / "members"
        place.mkdir(exist_ok=True)
        for other, certificate in public.items():
            _write(place / f"{other}.pem", certificate)


def _authority(folder: Path) -> tuple[Member, ec.EllipticCurvePrivateKey]:
    try:
        key = serialization.load_pem_private_key((folder / "ca-key.pem").read_bytes(), None)
    except FileNotFoundError:
        raise CertificateError(f"{folder}: there is no authority; `farhand certs init` makes one") from None
    except (OSError, ValueError, TypeError):
        raise CertificateError(f"{folder / 'ca-key.pem'}: is not a readable private key") from None
    if not isinstance(key, ec.EllipticCurvePrivateKey):
        raise CertificateError(f"{folder / 'ca-key.pem'}: is not a key of `farhand certs init`")
    return read_certificate(folder / "ca.pem"), key


def check_days(days: float) -> None:
    """Raise InputError unless a certificate can be valid for so long; a negative one has ended already."""
    if not (math.isfinite(days) and abs(days) <= MAX_DAYS):
        raise InputError(f"--days {days}: must be a number of days up to {MAX_DAYS:g}")


def _builder(
    subject: x509.Name, issuer: x509.Name, key: ec.EllipticCurvePrivateKey, days: float
) -> x509.CertificateBuilder:
    return x509.CertificateBuilder(
        issuer_name=issuer,
        subject_name=subject,
        public_key=key.public_key(),
        serial_number=x509.random_serial_number(),
        not_valid_before=utc_after(min(0.0, days) - CLOCK_DIFFERENCE_DAYS),
        not_valid_after=utc_after(days),
    )


def _usage(digital_signature: bool = False, key_cert_sign: bool = False) -> x509.KeyUsage:
    return x509.KeyUsage(
        digital_signature=digital_signature,
        key_cert_sign=key_cert_sign,
        crl_sign=key_cert_sign,
        content_commitment=False,
        key_encipherment=False,
        data_encipherment=False,
        key_agreement=False,
        encipher_only=False,
        decipher_only=False,
    )


def _private(key: ec.EllipticCurvePrivateKey) -> bytes:
    return key.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    )


def _write(path: Path, content: bytes, secret: bool = False) -> None:
    """Write a file whole or not at all; a secret one is never readable by others, not even while written."""
    temporary = path.with_name(path.name + ".new")
    temporary.unlink(missing_ok=True)
    descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600 if secret else 0o644)
    with os.fdopen(descriptor, "wb") as file:
        file.write(content)
    temporary.replace(path)
