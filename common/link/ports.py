"""Free ports on loopback."""

import random
import socket

from farhand.common.errors import EndpointError

LOW_PORT, HIGH_PORT = 20_000, 32_000  # below the range from which outgoing connections draw theirs


def free_ports(count: int) -> list[int]:
    """Ports that nobody listened on a moment ago; raises EndpointError where there are not so many."""
    found: list[int] = []
    candidates = list(range(LOW_PORT, HIGH_PORT))
    random.SystemRandom().shuffle(candidates)
    for port in candidates:
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
        found.append(port)
        if len(found) == count:
            return found
    raise EndpointError(f"no {count} free ports on 127.0.0.1 between {LOW_PORT} and {HIGH_PORT}")
