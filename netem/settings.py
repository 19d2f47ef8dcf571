"""What the emulator's program is asked for."""

from typing import Any

import msgspec

from farhand.common.scenario.section import Section
from farhand.netem.netem_node import DIRECTIONS
from farhand.netem.release_queue import Limits
from farhand.netem.spec import Spec, parse_spec


class NetworkSettings(Section, frozen=True, kw_only=True):
    """Network SPECs for each direction, as on the command line, which goes before them; None: not said."""

    uplink: str | None = None
    downlink: str | None = None


class NetemSettings(msgspec.Struct, frozen=True, kw_only=True):
    """What `farhand netem` was asked for.

    Attributes:
        listen_operator, listen_robot: endpoints that the two sides connect to; empty: none.
        connect_operator, connect_robot: endpoints to connect to.
        router: the sides that are connected to and not listened for are routers, whose clients it is to be.
        uplink, downlink: SPECs.
        seed: of all draws.
        stats: JSON file for the statistics at the end.
        log: CSV file for the fate of every message.
        timeline: TOML file of changes.
        control: endpoint or port of live control, on this host.
        metrics: port of the Prometheus metrics, 0 for none.
        ready_file: written, and ready_fd: written to and closed, when both sides listen.
        realtime: ask for SCHED_FIFO.
        limits: bounds of each direction's memory.
        tls: further (path, value) session settings.
        robot_networks: (robot, direction or both, SPEC) where a robot has a network of its own.
        certificates: folder for mutual TLS and access control on both sides; empty: none.
    """

    listen_operator: str = "tcp/127.0.0.1:7447"
    listen_robot: str = "tcp/127.0.0.1:7448"
    connect_operator: tuple[str, ...] = ()
    connect_robot: tuple[str, ...] = ()
    router: bool = False
    uplink: str = "none"
    downlink: str = "none"
    seed: int = 0
    stats: str | None = None
    log: str | None = None
    timeline: str | None = None
    control: str | None = None
    metrics: int = 0
    ready_file: str | None = None
    ready_fd: int | None = None
    realtime: bool = True
    limits: Limits = Limits()
    tls: tuple[tuple[str, Any], ...] = ()
    certificates: str = ""
    robot_networks: tuple[tuple[str, str, str], ...] = ()

    def own_networks(self) -> dict[str, dict[str, Spec]]:
        """The robots' own networks, by robot and direction; the later of two wins, and one direction over both."""
        found: dict[str, dict[str, Spec]] = {}
        for robot, direction, text in sorted(self.robot_networks, key=lambda own: own[1] != "both"):
            names = DIRECTIONS if direction == "both" else (direction,)
            found.setdefault(robot, {}).update(dict.fromkeys(names, parse_spec(text)))
        return found
