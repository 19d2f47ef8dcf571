"""The emulator's place in the network: two Zenoh sessions, one a side, which know nothing of each other.

Both listen and the ends only connect, or each connects to a router; all scouting is off. So the ends cannot
find each other, and what goes from one side to the other goes through the emulator. A program connected to
both sides is noticed.
"""

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from farhand.common.link.zenoh_link import open_session
from farhand.common.timing.clock import SystemClock
from farhand.netem.zenoh_side import ZenohSide


class Proxy:
    """The two sessions.

    Args:
        listen_operator, listen_robot: endpoints, e.g. tcp/127.0.0.1:7447; empty: none.
        clock: stamps arrivals.
        wake: called when something has arrived, in a Zenoh thread; must only notify.
        connect_operator, connect_robot: endpoints to connect to, e.g. of a Zenoh router.
        tls: further (path, value) session settings for both sessions, such as certificates.
        tls_robot: the same for the robot's session, where it differs.
        on_bypass: called, in a Zenoh thread, with a line that says who is connected to both sides.

    Attributes:
        operator_link, robot_link: the sides, as links.
        bypasses: Zenoh ids that were seen on both sides.

    Raises:
        EndpointError: a port is taken, or an endpoint is malformed.
    """

    def __init__(
        self,
        listen_operator: str,
        listen_robot: str,
        clock: SystemClock,
        wake: Callable[[], None],
        connect_operator: Sequence[str] = (),
        connect_robot: Sequence[str] = (),
        tls: Iterable[tuple[str, object]] | None = None,
        on_bypass: Callable[[str], None] | None = None,
        tls_robot: Iterable[tuple[str, object]] | None = None,
    ) -> None:
        extra = list(tls or ())
        extra_robot = extra if tls_robot is None else list(tls_robot)
        self.bypasses: set[str] = set()
        self._on_bypass = on_bypass
        operator = open_session(connect_operator, [listen_operator] if listen_operator else (), extra=extra)
        try:
            robot = open_session(connect_robot, [listen_robot] if listen_robot else (), extra=extra_robot)
        except BaseException:
            operator.close()  # type: ignore[no-untyped-call]
            raise
        self.operator_link = ZenohSide("operator", operator, clock, wake)
        self.robot_link = ZenohSide("robot", robot, clock, wake)
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
