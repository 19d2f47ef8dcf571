"""The emulator as a program: the proxy, the node, live control, and what they did at the end."""

import os
import sys
import threading
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Protocol, TypeVar

import msgspec
from rich.console import Console

from farhand.common.errors import FarhandError, InputError
from farhand.common.link.presence import answerer
from farhand.common.messages.keys import about_key, alive_key
from farhand.common.process.outputs import check_writable, survive
from farhand.common.process.signals import say, stop_event_on_signals
from farhand.common.process.teller import Teller
from farhand.common.process.terminal import spare_the_terminal
from farhand.common.result_file import write_result, write_whole
from farhand.common.timing.clock import SystemClock
from farhand.common.timing.loop import RealtimeLoop
from farhand.common.timing.slot import Slot
from farhand.common.trust.tls import load_folder, watch_names
from farhand.netem.announcer import Announcer
from farhand.netem.control import ControlServer, control_endpoint, look_at
from farhand.netem.emulation import Emulation
from farhand.netem.fate_server import FateServer
from farhand.netem.measure.fate_history import FateHistory
from farhand.netem.measure.message_log import CsvLog
from farhand.netem.measure.metrics import MetricsServer
from farhand.netem.measure.report import print_statistics
from farhand.netem.measure.result import NetemResult
from farhand.netem.netem_node import ConservationError, NetemNode
from farhand.netem.proxy import Meeting, Proxy
from farhand.netem.settings import NetemSettings as NetemSettings
from farhand.netem.spec import parse_spec
from farhand.netem.timeline import load_timeline


class _Closable(Protocol):
    def close(self) -> None: ...


C = TypeVar("C", bound=_Closable)
SWITCH_INTERVAL = 0.0002
"""How long another Python thread may keep the emulator's from running (s); 5 ms is Python's own."""


def run_netem(
    settings: NetemSettings,
    stop_event: threading.Event | None = None,
    console: Console | None = None,
    on_ready: Callable[[], None] | None = None,
) -> NetemResult:
    """Run the emulator until `stop_event` is set; returns, prints and writes its statistics.

    Args:
        settings: what to do.
        stop_event: ends it; None runs until the process is killed.
        console: where the table goes at the end; None prints nothing.
        on_ready: called when both sides listen.

    Raises:
        InputError: a SPEC, file or endpoint cannot be used.
        ConservationError: at the end, a message is not accounted for.
    """
    _check(settings)
    stop_event = stop_event or threading.Event()
    with ExitStack() as closing:
        program = _Emulator(settings, closing, stop_event)
        _tell_ready(settings)
        if on_ready is not None:
            on_ready()
        program.run()
    if program.log is not None and program.log.trouble:
        say("netem", f"--log {settings.log}: {program.log.missing} rows are missing: {program.log.trouble}")
    statistics = program.statistics()
    if settings.stats:
        path = Path(settings.stats)
        survive(f"--stats {path}", lambda: write_result(statistics, path), lambda line: say("netem", line))
    if console is not None:
        survive("the table", lambda: print_statistics(statistics, console), lambda line: say("netem", line))
    program.node.check_conservation()
    if statistics.overflowed:
        raise ConservationError(
            f"netem: {statistics.overflowed} messages were lost before the emulator could take them: "
            "overloaded; these losses were not drawn"
        )
    return statistics


class _Emulator:
    """Everything that runs, opened in order; what is opened is closed by the stack, the last first.

    Args:
        settings: what to do, checked.
        closing: where what must be closed is put.
        stop_event: ends the loop.
    """

    def __init__(self, settings: NetemSettings, closing: ExitStack, stop_event: threading.Event) -> None:
        self._settings, self._closing = settings, closing
        self._clock, self._teller = SystemClock(), self._opened(Teller("netem"))
        self._loop: RealtimeLoop | None = None
        schedule = load_timeline(settings.timeline) if settings.timeline else None
        emulation = Emulation(
            parse_spec(settings.uplink),
            parse_spec(settings.downlink),
            settings.seed,
            settings.own_networks(),
            settings.limits,
        )
        self.log = self._opened(CsvLog(settings.log)) if settings.log else None
        history = FateHistory() if settings.control else None
        logs = [log for log in (self.log, history) if log is not None]
        self._proxy = self._open_proxy()
        self.node = NetemNode(
            self._proxy.operator_link,
            self._proxy.robot_link,
            emulation,
            logs=logs,
            schedule=schedule,
            instant=self._clock.now_ns,
        )
        slot = Slot(self._wake)
        if settings.control and history is not None:
            control = self._opened(ControlServer(settings.control, self.node, slot))
            self._opened(FateServer(history, self.node, self._clock, control.session, settings.seed))
        if settings.metrics:
            self._opened(MetricsServer(settings.metrics, lambda: look_at(self.node)))
        self._loop = RealtimeLoop(
            self.node,
            self._clock,
            message_driven=True,
            realtime=settings.realtime,
            until=lambda _: stop_event.is_set(),
        )
        self._loop.before.append(slot.serve)
        self._loop.after.append(Announcer(self._teller.say, self.node).look)

    def run(self) -> None:
        """Emulate until the event is set."""
        assert self._loop is not None
        before = sys.getswitchinterval()
        sys.setswitchinterval(SWITCH_INTERVAL)
        try:
            self._loop.run()
        finally:
            sys.setswitchinterval(before)

    def statistics(self) -> NetemResult:
        """What node and proxy counted."""
        return msgspec.structs.replace(
            self.node.statistics(),
            **self._proxy.statistics(),
            seed=self._settings.seed,
            realtime_priority=self._loop is not None and self._loop.has_realtime_priority,
        )

    def _open_proxy(self) -> Proxy:
        """The two sides, which say who they are and, with certificates, who has no right to be there."""
        settings = self._settings
        folder = load_folder(settings.certificates, "netem") if settings.certificates else None
        operator, robot = (
            Meeting(
                listen,
                connect,
                (*settings.tls, *(folder.settings(f"netem-{side}") if folder else ())),
                settings.router,
            )
            for side, listen, connect in (
                ("operator", settings.listen_operator, settings.connect_operator),
                ("robot", settings.listen_robot, settings.connect_robot),
            )
        )
        tell = self._teller.say
        proxy = self._opened(Proxy(operator, robot, self._clock, self._wake, on_bypass=tell))
        answer = answerer("netem", folder.own if folder else None)
        self._watched: list[object] = []
        for side in (proxy.operator_link, proxy.robot_link):
            side.announce(alive_key("netem", "netem"), answer, about_key("netem", "netem"))
            if folder is not None:
                self._watched.append(watch_names(side.session, folder, f"netem-{side.name}", tell))
        if folder is not None:
            self._opened(folder.watch_ends(tell))
        return proxy

    def _wake(self) -> None:
        if self._loop is not None:
            self._loop.notify()

    def _opened(self, closable: C) -> C:
        self._closing.callback(closable.close)
        return closable


def _check(settings: NetemSettings) -> None:
    """Raise InputError for what can be told before anything is opened."""
    if settings.seed < 0:
        raise InputError(f"--seed {settings.seed}: must be 0 or more")
    parse_spec(settings.uplink)
    parse_spec(settings.downlink)
    if settings.timeline:
        load_timeline(settings.timeline)
    if settings.control:
        control_endpoint(settings.control)
    check_writable(settings.stats, "--stats")
    check_writable(settings.log, "--log")
    check_writable(settings.ready_file, "--ready-file")


def _tell_ready(settings: NetemSettings) -> None:
    if settings.ready_file:
        path = Path(settings.ready_file)
        survive(
            f"--ready-file {path}",
            lambda: write_whole(path, f"{os.getpid()}\n"),
            lambda line: say("netem", line),
        )
    if settings.ready_fd is not None:
        os.write(settings.ready_fd, b"ready\n")
        os.close(settings.ready_fd)


def main() -> int:
    """`python -m farhand.netem.main SETTINGS` with settings as JSON: the emulator as a process of its own."""
    spare_the_terminal()
    try:
        settings = msgspec.json.decode(sys.argv[1].encode(), type=NetemSettings)
        run_netem(settings, stop_event_on_signals())
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    except FarhandError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
