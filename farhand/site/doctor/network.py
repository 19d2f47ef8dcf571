"""The doctor's look at an endpoint below Zenoh: does the port answer, and do both sides trust each other."""

import socket
import ssl
from typing import cast

from farhand.common.link.endpoints import Endpoint, parse_endpoint
from farhand.common.timing.clock import utc_seconds
from farhand.common.trust.certificate import WARN_DAYS, today
from farhand.common.trust.tls import TlsFolder
from farhand.site.findings import Finding

CONNECT_TIME = 3.0
REFUSAL_TIME = 0.5


def dial(endpoint: Endpoint) -> socket.socket:
    """A TCP connection to an endpoint, over the device that it names; raises OSError."""
    host, port = endpoint.host, endpoint.port
    if endpoint.device:
        found = str(socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][4][0])
        host = f"{found.partition('%')[0]}%{endpoint.device}" if ":" in found else found
    return socket.create_connection((host, port), CONNECT_TIME)


def probe_tcp(endpoint: str) -> Finding:
    """Whether the port accepts a connection."""
    parts = parse_endpoint(endpoint)
    host, port, what = parts.host, parts.port, "reachability"
    try:
        dial(parts).close()
    except socket.gaierror:
        return Finding("bad", what, f"no host is called {host!r}", "see the name, or give the address")
    except ConnectionRefusedError:
        remedy = "start the program there, see its --listen and the port"
        return Finding("bad", what, f"{host} refuses port {port}: nothing listens there", remedy)
    except TimeoutError:
        remedy = f"let TCP port {port} through the firewalls; is the host up?"
        return Finding("bad", what, f"{host} port {port} does not answer", remedy)
    except OSError as error:
        remedy = "see address, cable and routes of this host"
        return Finding("bad", what, f"{host} cannot be reached: {error.strerror}", remedy)
    return Finding("good", what, f"{host} port {port} accepts")


def probe_tls(endpoint: str, folder: TlsFolder) -> Finding:
    """Whether both sides accept each other's certificates."""
    parts = parse_endpoint(endpoint)
    what = "TLS"
    context = ssl.create_default_context(cafile=str(folder.path / "ca.pem"))
    context.load_cert_chain(folder.path / "cert.pem", folder.path / "key.pem")
    try:
        with (
            dial(parts) as plain,
            context.wrap_socket(plain, server_hostname=parts.host) as secured,
        ):
            certificate = secured.getpeercert() or {}
            subject = cast(tuple[tuple[tuple[str, str], ...], ...], certificate.get("subject", ()))
            ends = ssl.cert_time_to_seconds(str(certificate["notAfter"]))
            names = dict(pair for group in subject for pair in group)
            secured.settimeout(REFUSAL_TIME)  # with TLS 1.3 a refusal comes after the handshake
            try:
                if secured.recv(1) == b"":
                    return Finding("bad", what, "the other side closed it", "see the log there")
            except TimeoutError:
                pass
    except ssl.SSLCertVerificationError as error:
        remedy = "its certificate must be of the same authority, and issued with --host for this name"
        if "expired" in error.verify_message or "not yet valid" in error.verify_message:
            remedy = f"is this host's clock right ({today()})? if so, `farhand certs renew` it, copy, restart there"
        return Finding("bad", what, f"its certificate is not trusted here: {error.verify_message}", remedy)
    except ssl.SSLError as error:
        if "WRONG_VERSION" in (error.reason or "") or "RECORD_LAYER" in (error.reason or ""):
            return Finding(
                "bad", what, "there is no TLS behind the port", "start the program there with --tls"
            )
        remedy = "is this certificate of the same authority as the other side's?"
        if "EXPIRED" in (error.reason or ""):
            remedy = "is the clock of the host there right? if so, `farhand certs renew` ours"
        return Finding("bad", what, f"our certificate was refused: {error.reason}", remedy)
    except OSError as error:
        return Finding("bad", what, f"broken off: {error}", "is there a program with --tls behind the port?")
    name, days = names.get("commonName", "?"), (ends - utc_seconds()) / 86_400.0
    found = f"{name} and {folder.own.name} accept each other"
    if days <= WARN_DAYS:
        remedy = f"`farhand certs renew {name}`, copy the folder there, restart"
        return Finding("note", what, f"{found}; {name} has {days:.0f} days left", remedy)
    return Finding("good", what, found)
