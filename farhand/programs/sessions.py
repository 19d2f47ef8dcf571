"""What the operator's and the robot's program open alike."""

import secrets
from collections.abc import Sequence

from farhand.common.errors import EndpointError


def random_session() -> int:
    """A session for one start of a program; never 0."""
    return secrets.randbelow((1 << 62) - 1) + 1


def session_mode(router: bool, listen: Sequence[str]) -> str:
    """The Zenoh mode of a program's session; raises EndpointError."""
    if router and listen:
        raise EndpointError(
            f"--listen {listen[0]}: a router's client only connects; leave --listen or --router out"
        )
    return "client" if router else "peer"
