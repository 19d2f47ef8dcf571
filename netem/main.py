"""The emulator as a program: the proxy, the node, live control, and what they did at the end."""

import os
import signal
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
from rich.console import Console

from farhand.common.errors import FarhandError, InputError
from farhand.common.link.presence import answerer
from farhand.common.messages.keys import about_key, alive_key
from farhand.common.result_file import write_result
from farhand.common.timing.clock import SystemClock
from farhand.common.timing.executor import RealtimeExecutor
from farhand.common.trust.tls import load_folder, watch_names
from farhand.netem.control import ControlServer, control_endpoint
from farhand.netem.emulation import Emulation
from farhand.netem.measure.message_log import CsvLog
from farhand.netem.measure.metrics import MetricsServer
from farhand.netem.measure.report import print_statistics
from farhand.netem.netem_node import ConservationError, NetemNode
from farhand.netem.proxy import Proxy
from farhand.netem.result import NetemResult
from farhand.netem.settings import NetemSettings as NetemSettings
from farhand.netem.spec import parse_spec
from farhand.netem.timeline import load_timeline

HOUSEKEEPING_NS = 50_000_000
SWITCH_INTERVAL = 0.0002
"""How long another Python thread may keep the emulator's from running (s); 5 ms is Python's own."""


class _Program:
    """What the executor runs: the node, and around it requests and a look at the stop event."""

    def __init__(
        self,
        node: NetemNode,
        control: ControlServer | None,
        stopped: Callable[[], bool],
        say: Callable[[str], None],
    ) -> None:
        self.stop: Callable[[], None] = lambda: None
        self._node = node
        self._control = control
        self._stopped = stopped
        self._say = say
        self._bypass_said = False

    def step(self, now_ns: int) -> int | None:
        """One step of the node."""
        if self._control is not None:
            self._control.serve(self._node, now_ns)
        next_ns = self._node.step(now_ns)
        if self._stopped():
            self.stop()
        for line in self._node.take_notes():
            self._say(line)
        if not self._bypass_said and any(t.bypassed for t in self._node.round_trips.values()):
            self._bypass_said = True
            self._say(
                "a robot answers a command that the emulator did not let through: something goes past it"
            )
        housekeeping_ns = now_ns + HOUSEKEEPING_NS
        return housekeeping_ns if next_ns is None else min(next_ns, housekeeping_ns)


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
    if settings.seed < 0:
        raise InputError(f"--seed {settings.seed}: must be 0 or more")
    uplink, downlink = parse_spec(settings.uplink), parse_spec(settings.downlink)
    schedule = load_timeline(settings.timeline) if settings.timeline else None
    if settings.control:
        control_endpoint(settings.control)
    _check_writable(settings.stats)
    stop_event = stop_event or threading.Event()
    folder = load_folder(settings.certificates, "netem") if settings.certificates else None
    sides = {
        side: [*settings.tls, *(folder.settings(f"netem-{side}") if folder else ())]
        for side in ("operator", "robot")
    }
    clock = SystemClock()
    executor: RealtimeExecutor | None = None

    def wake() -> None:
        if executor is not None:
            executor.notify()

    log = CsvLog(settings.log) if settings.log else None
    opened: list[Any] = [log] if log else []
    try:
        proxy = Proxy(
            settings.listen_operator,
            settings.listen_robot,
            clock,
            wake,
            settings.connect_operator,
            settings.connect_robot,
            sides["operator"],
            on_bypass=say,
            tls_robot=sides["robot"],
        )
        opened.append(proxy)
        answer = answerer("netem", folder.own if folder else None)
        watched = []
        for side in (proxy.operator_link, proxy.robot_link):
            side.announce(alive_key("netem", "netem"), answer, about_key("netem", "netem"))
            if folder is not None:
                watched.append(watch_names(side.session, folder, f"netem-{side.name}", say))
        if folder is not None:
            opened.append(folder.watch_ends(say))
        node = NetemNode(
            proxy.operator_link,
            proxy.robot_link,
            Emulation(uplink, downlink, settings.seed, settings.own_networks(), settings.limits),
            log=log,
            schedule=schedule,
            instant=clock.now_ns,
        )
        control = ControlServer(settings.control, wake) if settings.control else None
        if control is not None:
            opened.append(control)
        if settings.metrics:
            opened.append(MetricsServer(settings.metrics, node.statistics))
        program = _Program(node, control, stop_event.is_set, say)
        executor = RealtimeExecutor(program, clock, message_driven=True, realtime=settings.realtime)
        program.stop = executor.stop
        _tell_ready(settings)
        if on_ready is not None:
            on_ready()
        before = sys.getswitchinterval()
        sys.setswitchinterval(SWITCH_INTERVAL)
        try:
            executor.run()
        finally:
            sys.setswitchinterval(before)
    finally:
        for each in reversed(opened):
            each.close()
    statistics = msgspec.structs.replace(
        node.statistics(),
        **proxy.statistics(),
        seed=settings.seed,
        realtime_priority=executor.has_realtime_priority,
    )
    if settings.stats:
        write_result(statistics, Path(settings.stats))
    if console is not None:
        print_statistics(statistics, console)
    node.check_conservation()
    if statistics.overflowed:
        raise ConservationError(
            f"netem: {statistics.overflowed} messages were lost before the emulator could take them: "
            "overloaded; these losses were not drawn"
        )
    return statistics


def _tell_ready(settings: NetemSettings) -> None:
    if settings.ready_file:
        Path(settings.ready_file).write_text(f"{os.getpid()}\n", encoding="utf-8")
    if settings.ready_fd is not None:
        os.write(settings.ready_fd, b"ready\n")
        os.close(settings.ready_fd)


def _check_writable(path: str | None) -> None:
    if path and not Path(path).resolve().parent.is_dir():
        raise InputError(f"--stats {path}: no such folder: {Path(path).resolve().parent}")


def say(line: str) -> None:
    """One line for people, on stderr."""
    print(f"netem: {line}", file=sys.stderr, flush=True)


def stop_on_signals() -> threading.Event:
    """An event that SIGTERM and SIGINT set; to be called from the main thread."""
    event = threading.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: event.set())
    return event


def main() -> int:
    """`python -m farhand.netem.main SETTINGS` with settings as JSON: the emulator as a process of its own."""
    try:
        settings = msgspec.json.decode(sys.argv[1].encode(), type=NetemSettings)
        run_netem(settings, stop_on_signals())
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    except FarhandError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
