"""Endpoints: what is one, what is not, and what Zenoh and plain sockets are given for it."""

import json
import socket

import pytest

from farhand.common.errors import EndpointError
from farhand.common.link.endpoints import (
    Endpoint,
    check_device,
    check_endpoint,
    check_name,
    for_zenoh,
    is_loopback,
    parse_endpoint,
)
from farhand.common.link.zenoh_link import open_session, zenoh_config


@pytest.mark.parametrize(
    ("endpoint", "zenohs", "parts"),
    [
        ("tcp/10.0.0.2:7447", "tcp/10.0.0.2:7447", ("tcp", "10.0.0.2", 7447, "")),
        ("tls/robot.lab:7447", "tls/robot.lab:7447", ("tls", "robot.lab", 7447, "")),
        ("tcp/[::1]:7447", "tcp/[::1]:7447", ("tcp", "::1", 7447, "")),
        ("tcp/[fe80::1%eth0]:7447", "tcp/[fe80::1]:7447#iface=eth0", ("tcp", "fe80::1", 7447, "eth0")),
        ("tcp/[fe80::1]:7447#iface=eth0", "tcp/[fe80::1]:7447#iface=eth0", ("tcp", "fe80::1", 7447, "eth0")),
        ("tls/[fe80::1%2]:7447", "tls/[fe80::1%2]:7447", ("tls", "fe80::1", 7447, "2")),
        ("tcp/10.0.0.2:7447#iface=eth0", "tcp/10.0.0.2:7447#iface=eth0", ("tcp", "10.0.0.2", 7447, "eth0")),
    ],
)
def test_endpoints_that_are(endpoint, zenohs, parts):
    assert check_endpoint(endpoint) == endpoint
    assert for_zenoh(endpoint) == zenohs
    assert parse_endpoint(endpoint) == Endpoint(*parts)
    config = zenoh_config([endpoint], [endpoint])
    for end in ("connect", "listen"):
        assert json.loads(config.get_json(f"{end}/endpoints")) == [zenohs]
    assert is_loopback(endpoint) == (endpoint == "tcp/[::1]:7447")


@pytest.mark.parametrize(
    "endpoint",
    [
        "tcp/[::1%]:7447",
        "tcp/[fe80::1%e th]:7447",
        "tcp/a:7447#x=y",
        "tcp/a%e:7447",
        "tcp/[fe80::1%eth0]:7447#iface=eth0",
    ],
)
def test_endpoints_that_are_not(endpoint):
    with pytest.raises(EndpointError, match="PROTOCOL/HOST:PORT"):
        check_endpoint(endpoint)


def test_a_device_that_is_not_there_is_said_before_anything_is_opened():
    number, name = socket.if_nameindex()[0]
    check_device(f"tcp/[fe80::1%{name}]:7447")
    check_device(f"tcp/[fe80::1%{number}]:7447")
    for endpoint in ("tcp/[fe80::1%nosuch0]:7447", "tcp/[fe80::1]:7447#iface=nosuch0"):
        with pytest.raises(EndpointError, match=f"no network device 'nosuch0'.*{name}"):
            open_session([endpoint])


@pytest.mark.parametrize(
    ("endpoint", "instead"),
    [
        ("tls/[::1]:7447", "'::1 NAME'.* tls/NAME:7447, .*--host NAME"),
        ("tls/[fe80::1%eth1]:7448", "'fe80::1 NAME'.* tls/NAME:7448#iface=eth1, "),
        ("quic/[fe80::1]:7447", " quic/NAME:7447#iface=eth0, "),
    ],
)
def test_a_certificate_has_no_name_in_brackets(endpoint, instead):
    with pytest.raises(EndpointError, match=instead):
        open_session([endpoint])
    assert check_endpoint(endpoint)  # one may listen there
    assert check_name("tls/10.0.0.2:7447")
    assert check_name("tcp/[::1]:7447")
