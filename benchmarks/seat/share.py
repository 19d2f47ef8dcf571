"""What the console costs: its share of a core, before a program that reports as an operator's does."""

import threading
from contextlib import ExitStack
from typing import Any

import psutil

from benchmarks.seat.threads import listen, load, started
from farhand.common.link.link import Packet
from farhand.common.link.ports import free_ports
from farhand.common.link.zenoh_link import ZenohLink, open_session
from farhand.common.messages.codec import encode
from farhand.common.messages.keys import mirror_key, report_key
from farhand.common.messages.scene import Obstacle
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.programs.command_line import ConsoleWords
from farhand.testing import Programs, command, description, report, scene, state
from tests.operator_side.console.caller import Caller

STATE_HZ, REPORT_HZ, SCENE_HZ = 100, 50, 1


def share(pages: int, obstacles: int, seconds: float) -> dict[str, float]:
    """Of a core that the console takes, before a program that reports at 50 Hz; the driver steers at 50 Hz."""
    clock, pause, ended = SystemClock(), threading.Event(), threading.Event()
    around = tuple(Obstacle(f"post-{k}", (0.5, 0.01 * k, 0.3), 0.05) for k in range(obstacles))
    with ExitStack() as closing:
        endpoint_port, page_port = free_ports(2)
        endpoint, host = f"tcp/127.0.0.1:{endpoint_port}", f"127.0.0.1:{page_port}"
        link = ZenohLink(open_session((), [endpoint]), [], clock)
        closing.callback(link.close)
        programs = closing.enter_context(Programs())
        console = programs.start(*ConsoleWords(connect=endpoint, listen=host, robot="r").words())
        console.wait_for("drive at")
        started(closing, ended, _publish, link, around, ended)
        callers = [closing.enter_context(Caller(host)) for _ in range(pages)]
        for caller in callers:
            caller.hear("frame", lambda told: not told["locked"])
        callers[0].says(kind="do", what="take")
        for caller in callers:
            started(closing, ended, listen, caller, ended)
        process = psutil.Process(console.pid)
        pause.wait(1.0)
        before, began_ns = process.cpu_times(), clock.now_ns()
        while clock.now_ns() < began_ns + to_ns(seconds):
            callers[0].steer(clock.now_ns(), engaged=True, press=1)
            pause.wait(0.02)
        after, took = process.cpu_times(), (clock.now_ns() - began_ns) * 1e-9
        ended.set()
    return {"share": (after.user + after.system - before.user - before.system) / took, "load": load()}


def _publish(link: ZenohLink, around: tuple[Obstacle, ...], ended: threading.Event) -> None:
    """What an operator's program says to its console, and mirrors to it."""
    seq = 0
    while not ended.wait(1.0 / STATE_HZ):
        seq += 1
        told: dict[str, Any] = {mirror_key("r", "state"): state(seq)}
        if seq % (STATE_HZ // REPORT_HZ) == 0:
            told[report_key("r")] = report(seq)
            told[mirror_key("r", "command")] = command(seq, plan=((0.1, 0.0, 0.0),) * 49)
        if seq % (STATE_HZ // SCENE_HZ) == 1:
            told[mirror_key("r", "scene")] = scene(seq, *around)
            told[mirror_key("r", "description")] = description(seq, model="ur5")
        for key, message in told.items():
            link.send(Packet(key, encode(message)))
