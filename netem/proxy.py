"""The emulator's place in the network: two Zenoh sessions, one a side, which know nothing of each other.

Both listen and the ends only connect, or each connects to a router; all scouting is off. So the ends cannot
find each other, and what goes from one side to the other goes through the emulator. A program connected to
both sides is noticed.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import zenoh

from farhand.common.link.zenoh_link import open_session
from farhand.common.timing.clock import SystemClock
from farhand.netem.zenoh_side import ZenohSide


@dataclass(frozen=True, slots=True)
class Meeting:
    """How one side is met.

    Attributes:
        listen: endpoint, e.g. tcp/127.0.0.1:7447; empty: none.
        connect: endpoints to connect to, e.g. of a Zenoh router.
        extra: further (path, value) session settings, such as certificates.
        router: what is connected to is a router that has peers, which it routes to clients only: be one.
    """

    listen: str = ""
    connect: tuple[str, ...] = ()
    extra: tuple[tuple[str, object], ...] = ()
    router: bool = False

    def open(self) -> zenoh.Session:
        """A session of its own; raises EndpointError."""
        mode = "client" if self.router and self.connect and not self.listen else "peer"
        return open_session(self.connect, [self.listen] if self.listen else (), mode=mode, extra=self.extra)


class Proxy:
    """The two sessions.

    Args:
        operator, robot: how the two sides are met.
        clock: stamps arrivals.
        wake: called when something has arrived, in a Zenoh thread; must only notify.
        on_bypass: called, in a Zenoh thread, with a line that says who is connected to both sides.

    Attributes:
        operator_link, robot_link: the sides, as links.
        bypasses: Zenoh ids that were seen on both sides.

    Raises:
        EndpointError: a port is taken, or an endpoint is malformed.
    """

    def __init__(
        self,
        operator: Meeting,
        robot: Meeting,
        clock: SystemClock,
        wake: Callable[[], None],
        on_bypass: Callable[[str], None] | None = None,
    ) -> None:
        self.bypasses: set[str] = set()
        self._on_bypass = on_bypass
        near = operator.open()
        try:
            far = robot.open()
        except BaseException:
            near.close()  # type: ignore[no-untyped-call]
            raise
        self.operator_link = ZenohSide("operator", near, clock, wake)
        self.robot_link = ZenohSide("robot", far, clock, wake)
        self.operator_link.open(self._peers_changed)
        self.robot_link.open(self._peers_changed)

    def peers(self) -> dict[str, list[str]]:
        """Zenoh ids of those connected now, by side ("operator", "robot")."""
        return {side.name: sorted(side.peers) for side in (self.operator_link, self.robot_link)}

    def statistics(self) -> dict[str, Any]:
        """What the sessions count, by the name that it has in NetemResult."""
        sides = (self.operator_link, self.robot_link)
        return {
            "peers": self.peers(),
            "both_sides": sorted(self.bypasses),
            "overflowed": sum(side.inbox.overflowed for side in sides),
            "local": sum(side.local for side in sides),
            "send_errors": sum(sum(side.errors.values()) for side in sides),
        }

    def close(self) -> None:
        """Close both sessions."""
        self.operator_link.close()
        self.robot_link.close()

    def _peers_changed(self) -> None:
        both = (self.operator_link.peers & self.robot_link.peers) - self.bypasses
        self.bypasses |= both
        if self._on_bypass is not None:
            for peer in sorted(both):
                self._on_bypass(
                    f"peer {peer} is connected to both sides of the emulator: what it relays goes past it"
                )
