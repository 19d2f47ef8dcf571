"""Endpoints: what is one, and what is not."""

import pytest

from farhand.common.errors import EndpointError
from farhand.common.link.zenoh_link import check_endpoint, is_loopback, zenoh_config


@pytest.mark.parametrize(
    "endpoint",
    [
        "tcp/10.0.0.2:7447",
        "tls/robot.lab:7447",
        "tcp/[::1]:7447",
        "tcp/[fe80::1%eth0]:7447",
        "tcp/[fe80::1]:7447#iface=eth0",
    ],
)
def test_endpoints_that_are(endpoint):
    assert check_endpoint(endpoint) == endpoint
    zenoh_config([endpoint])
    assert is_loopback(endpoint) == ("::1]" in endpoint and "fe80" not in endpoint)


@pytest.mark.parametrize(
    "endpoint", ["tcp/[::1%]:7447", "tcp/[fe80::1%e th]:7447", "tcp/a:7447#x=y", "tcp/a%e:7447"]
)
def test_endpoints_that_are_not(endpoint):
    with pytest.raises(EndpointError, match="PROTOCOL/HOST:PORT"):
        check_endpoint(endpoint)
