"""The emulator as a program: the proxy, the node, live control, and what they did at the end."""

import os
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
from farhand.common.process.outputs import check_writable
from farhand.common.process.signals import say, stop_event_on_signals
from farhand.common.process.teller import Teller
from farhand.common.result_file import write_result
from farhand.common.timing.clock import SystemClock
from farhand.common.timing.loop import RealtimeLoop
from farhand.common.timing.slot import Slot
from farhand.common.trust.tls import load_folder, watch_names
from farhand.netem.announcer import Announcer
from farhand.netem.control import ControlServer, control_endpoint, look_at
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
    if settings.seed < 0:
        raise InputError(f"--seed {settings.seed}: must be 0 or more")
    uplink, downlink = parse_spec(settings.uplink), parse_spec(settings.downlink)
    schedule = load_timeline(settings.timeline) if settings.timeline else None
    if settings.control:
        control_endpoint(settings.control)
    check_writable(settings.stats, "--stats")
    stop_event = stop_event or threading.Event()
    folder = load_folder(settings.certificates, "netem") if settings.certificates else None
    sides = {
        side: [*settings.tls, *(folder.settings(f"netem-{side}") if folder else ())]
        for side in ("operator", "robot")
    }
    clock, teller = SystemClock(), Teller("netem")
    loop: RealtimeLoop | None = None

    def wake() -> None:
        if loop is not None:
            loop.notify()

    opened: list[Any] = [teller]
    try:
        log = CsvLog(settings.log) if settings.log else None
        if log is not None:
            opened.append(log)
        proxy = Proxy(
            settings.listen_operator,
            settings.listen_robot,
            clock,
            wake,
            settings.connect_operator,
            settings.connect_robot,
            sides["operator"],
            on_bypass=teller.say,
            tls_robot=sides["robot"],
        )
        opened.append(proxy)
        answer = answerer("netem", folder.own if folder else None)
        watched = []
        for side in (proxy.operator_link, proxy.robot_link):
            side.announce(alive_key("netem", "netem"), answer, about_key("netem", "netem"))
            if folder is not None:
                watched.append(watch_names(side.session, folder, f"netem-{side.name}", teller.say))
        if folder is not None:
            opened.append(folder.watch_ends(teller.say))
        node = NetemNode(
            proxy.operator_link,
            proxy.robot_link,
            Emulation(uplink, downlink, settings.seed, settings.own_networks(), settings.limits),
            log=log,
            schedule=schedule,
            instant=clock.now_ns,
        )
        slot = Slot(wake)
        if settings.control:
            opened.append(ControlServer(settings.control, node, slot))
        if settings.metrics:
            opened.append(MetricsServer(settings.metrics, lambda: look_at(node)))
        loop = RealtimeLoop(
            node,
            clock,
            message_driven=True,
            realtime=settings.realtime,
            until=lambda _: stop_event.is_set(),
        )
        loop.before.append(slot.serve)
        loop.after.append(Announcer(teller.say, node).look)
        _tell_ready(settings)
        if on_ready is not None:
            on_ready()
        before = sys.getswitchinterval()
        sys.setswitchinterval(SWITCH_INTERVAL)
        try:
            loop.run()
        finally:
            sys.setswitchinterval(before)
    finally:
        for each in reversed(opened):
            each.close()
    if log is not None and log.trouble:
        say("netem", f"--log {settings.log}: {log.missing} rows are missing: {log.trouble}")
    statistics = msgspec.structs.replace(
        node.statistics(),
        **proxy.statistics(),
        seed=settings.seed,
        realtime_priority=loop.has_realtime_priority,
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


def main() -> int:
    """`python -m farhand.netem.main SETTINGS` with settings as JSON: the emulator as a process of its own."""
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
