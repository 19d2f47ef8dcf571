"""Endpoints as people write them, PROTOCOL/HOST:PORT, and what Zenoh and plain sockets make of them.

A link-local address of IPv6 is good on one device only, which is named in one of two ways: tcp/[fe80::1%eth0]:7447, as
the system's own tools have it, or tcp/[fe80::1]:7447#iface=eth0, as Zenoh has it. Both are taken.
"""

import re
import socket
from dataclasses import dataclass

from farhand.common.errors import EndpointError

_ENDPOINT = re.compile(
    r"(tcp|tls|quic|udp|ws)/(?:\[([0-9a-fA-F:.]+)(?:%([A-Za-z0-9_.-]+))?\]|([A-Za-z0-9_.-]+)):(\d{1,5})"
    r"(?:#iface=([A-Za-z0-9_.-]+))?\Z"
)
_LOOPBACK = {"127.0.0.1", "localhost", "::1"}


@dataclass(frozen=True, slots=True)
class Endpoint:
    """The parts of an endpoint.

    Attributes:
        protocol: tcp, tls, quic, udp or ws.
        host: name or address, without brackets and device.
        port: 1 to 65535.
        device: network device that was named; empty: none.
    """

    protocol: str
    host: str
    port: int
    device: str


def parse_endpoint(text: str) -> Endpoint:
    """The parts of PROTOCOL/HOST:PORT; raises EndpointError where it has another form."""
    match = _ENDPOINT.match(text)
    if not match or not 0 < int(match[5]) < 65536 or (match[3] and match[6]):
        raise EndpointError(
            f"endpoint {text!r}: expected PROTOCOL/HOST:PORT such as tcp/127.0.0.1:7447 "
            "(tcp, tls, quic, udp or ws; port 1 to 65535; IPv6 in brackets, a link-local one with its device: "
            "tcp/[fe80::1%eth0]:7447)"
        )
    return Endpoint(match[1], match[2] or match[4], int(match[5]), match[3] or match[6] or "")


def check_endpoint(text: str) -> str:
    """The endpoint itself if it has the form PROTOCOL/HOST:PORT; raises EndpointError otherwise."""
    parse_endpoint(text)
    return text


def is_loopback(text: str) -> bool:
    """Whether an endpoint can be reached from this host only."""
    match = _ENDPOINT.match(text)
    return bool(match) and (match[2] or match[4]) in _LOOPBACK  # type: ignore[index]


def for_zenoh(text: str) -> str:
    """The endpoint as Zenoh takes it: it knows devices by number after %, by name only at the end.

    A number changes when a device is plugged in again, so the name stays a name. Raises EndpointError.
    """
    found = parse_endpoint(text)
    if "%" not in text or found.device.isdigit():
        return text
    return f"{found.protocol}/[{found.host}]:{found.port}#iface={found.device}"


def check_device(text: str) -> None:
    """Raise EndpointError where an endpoint names a network device that this host does not have."""
    device = parse_endpoint(text).device
    there = {f"{number}": name for number, name in socket.if_nameindex()}
    if device and device not in there and device not in there.values():
        names = ", ".join(there.values())
        raise EndpointError(
            f"endpoint {text}: this host has no network device {device!r} (there are {names})"
        )


def check_name(text: str) -> str:
    """The endpoint itself if Zenoh can connect to it; raises EndpointError for an IPv6 address where TLS needs a name.

    Zenoh compares the certificate with the address in brackets, which no certificate can have, and tries for ever.
    """
    found = parse_endpoint(text)
    if found.protocol in ("tls", "quic") and ":" in found.host:
        device = found.device or "eth0"
        link_local = f"#iface={device}" if found.device or found.host.lower().startswith("fe80") else ""
        raise EndpointError(
            f"endpoint {text}: to connect over {found.protocol} to an IPv6 address needs a name for it: put "
            f"'{found.host} NAME' into /etc/hosts, connect to {found.protocol}/NAME:{found.port}{link_local}, "
            "and issue the certificate there with --host NAME"
        )
    return text
