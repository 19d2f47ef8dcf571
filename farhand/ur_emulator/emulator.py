"""The emulator as one node: ports, controller, faults; a cycle each time it is due."""

from collections.abc import Callable
from dataclasses import dataclass

from farhand.common.timing.periodic import Periodic
from farhand.ur_emulator.controller import Controller
from farhand.ur_emulator.dashboard import DashboardHandler
from farhand.ur_emulator.faults import FaultCommands
from farhand.ur_emulator.rtde_server import RtdeHandler
from farhand.ur_emulator.script_ports import ScriptHandler
from farhand.ur_emulator.sockets import ProgramSockets
from farhand.ur_emulator.wire import Handler, Server, Wire

SECOND_NS = 1_000_000_000
MOST_BEHIND = 100
"""Cycles that are made good for at once, so that the controller's time goes with everybody's."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ports:
    """Where the controller listens; 0 takes any that is free."""

    primary: int = 30001
    secondary: int = 30002
    realtime: int = 30003
    rtde: int = 30004
    dashboard: int = 29999
    faults: int = 29900


class Emulator:
    """A controller behind its ports.

    Args:
        controller: what is emulated.
        address: where it listens.
        ports: see there.
        serial, model: what the dashboard says of the arm.
        takes: hands over the fault commands that came by other ways; called once a cycle.
    """

    def __init__(
        self,
        controller: Controller,
        address: str,
        ports: Ports,
        serial: str,
        model: str,
        takes: Callable[[], list[str]],
    ) -> None:
        self.controller, self.wire = controller, Wire()
        self._takes = takes
        self._sockets = ProgramSockets(self.wire)
        controller.listeners.append(self._sockets.close_all)
        self._owners: dict[str, RtdeHandler] = {}
        self._ticks = Periodic(round(SECOND_NS / controller.rate_hz))
        self.faults = FaultCommands(controller, self.wire, self.hang_up)
        self._servers: dict[str, Server] = {}
        makes: dict[str, Callable[..., Handler]] = {
            "rtde": lambda c: RtdeHandler(c, controller, self._owners),
            "dashboard": lambda c: DashboardHandler(c, controller, serial, model),
            "primary": lambda c: ScriptHandler(c, controller, self._sockets),
            "secondary": lambda c: ScriptHandler(c, controller, self._sockets),
            "realtime": lambda c: ScriptHandler(c, controller, self._sockets),
        }
        try:
            for name, make in makes.items():
                self._servers[name] = Server(address, getattr(ports, name), self.wire, name, make)
            # the faults' own port is no part of the controller: no cable of it is cut
            self._servers["faults"] = Server(address, ports.faults, Wire(), "faults", self.faults.handler)
        except BaseException:
            self.close()
            raise

    @property
    def ports(self) -> Ports:
        """Where it listens."""
        return Ports(**{name: server.port for name, server in self._servers.items()})

    def step(self, now_ns: int) -> int:
        """All cycles that are due; returns when the next one is (ns)."""
        for _ in range(min(self._ticks.due(now_ns), MOST_BEHIND)):
            self._cycle()
        next_ns = self._ticks.next_ns
        return now_ns if next_ns is None else next_ns

    def hang_up(self) -> None:
        """End all connections, as a controller does that starts anew."""
        for name, server in self._servers.items():
            if name != "faults":
                server.hang_up()
        self._sockets.close_all()

    def close(self) -> None:
        """End everything."""
        for server in self._servers.values():
            server.close()
        self._sockets.close_all()
        self.controller.close()

    def _cycle(self) -> None:
        controller = self.controller
        for line in self._takes():
            controller.say(self.faults.do(line))
        self._sockets.now = controller.now
        for server in self._servers.values():
            server.poll(controller.now)
        controller.cycle()
        self.faults.cycle()
        for handler in self._servers["rtde"].handlers:
            if isinstance(handler, RtdeHandler):
                handler.cycle(controller.now)
