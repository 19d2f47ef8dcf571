"""The operator's seat: how soon a press leaves the operator, what the console costs, and whom it makes late.

`python benchmarks/seat.py [--json FILE] [--quick]`. Real programs on loopback, a page as the console hears one, and
Chromium where it is installed. Run it on an idle machine: the load average is printed beside every figure, and what was
measured under load says little.
"""

import argparse
import json
import os
import statistics
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import psutil
from websockets.exceptions import ConnectionClosed

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from farhand.common.link.link import Packet
from farhand.common.link.ports import free_ports
from farhand.common.link.zenoh_link import ZenohLink, open_session
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.keys import mirror_key, report_key
from farhand.common.messages.scene import Obstacle
from farhand.common.timing.clock import SystemClock, to_ns, utc_seconds
from farhand.programs.command_line import ConsoleWords, NetemWords, OperatorWords, RecordWords, RobotWords
from farhand.testing import Programs, command, description, report, scene, state
from tests.operator_side.console.browser import CHROMIUM, DRIVER, Browser
from tests.operator_side.console.caller import Caller

TICK, BEYOND = 0.02, 0.015
"""Of the controller, and what may be added to it (s)."""
GHOST_WITHIN = 0.05
SHARE, LATER = 0.10, 1.2
STATE_HZ, REPORT_HZ, SCENE_HZ = 100, 50, 1


def run(quick: bool) -> dict[str, Any]:
    """All measurements of one run; durations in s, shares of one core."""
    seconds = 4.0 if quick else 12.0
    return {
        "processors": os.cpu_count(),
        "share": {
            name: share(pages, obstacles, seconds)
            for name, pages, obstacles in (
                ("one page", 1, 3),
                ("300 obstacles", 1, 300),
                ("four pages", 4, 3),
            )
        },
        "press": press(12 if quick else 60),
        "browser": browser(8 if quick else 40) if CHROMIUM and DRIVER else None,
        "late": late(1 if quick else 3, 6.0 if quick else 15.0),
    }


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
        _started(closing, ended, _publish, link, around, ended)
        callers = [closing.enter_context(Caller(host)) for _ in range(pages)]
        for caller in callers:
            caller.hear("frame", lambda told: not told["locked"])
        callers[0].says(kind="do", what="take")
        for caller in callers:
            _started(closing, ended, _listen, caller, ended)
        process = psutil.Process(console.pid)
        pause.wait(1.0)
        before, began_ns = process.cpu_times(), clock.now_ns()
        while clock.now_ns() < began_ns + to_ns(seconds):
            callers[0].steer(clock.now_ns(), engaged=True, press=1)
            pause.wait(0.02)
        after, took = process.cpu_times(), (clock.now_ns() - began_ns) * 1e-9
        ended.set()
    return {"share": (after.user + after.system - before.user - before.system) / took, "load": _load()}


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


def _listen(caller: Caller, ended: threading.Event) -> None:
    try:
        while not ended.is_set():
            caller.hear("frame")
    except ConnectionClosed:
        pass  # at the end


def press(count: int) -> dict[str, Any]:
    """From a press that is handed to the console's socket to the first command with a velocity that leaves."""
    with _system(console=True) as system:
        found, missed = [], 0
        for k in range(count):
            system.rest(0.35 + 0.013 * (k % 9))  # at every phase of the tick
            began_ns = system.press()
            try:
                found.append((system.moves(began_ns) - began_ns) * 1e-9)
            except AssertionError:
                missed += 1
            system.let_go()
        return _summary(found) | {
            "load": _load(),
            "missed": missed,
            "over": sum(each > TICK + BEYOND for each in found),
        }


def browser(count: int) -> dict[str, Any]:
    """The same from the instant of the key's event in a real page, and to the frame that shows the ghost's answer.

    The page's ghost is drawn in the animation frame after the key's event; without a mark of its own (`ghost`), the
    end of that frame counts.
    """
    with _system(console=False) as system, ExitStack() as closing:
        page = Browser()
        closing.callback(page.close)
        page.open(f"http://{system.host}/")
        for _ in range(400):
            if page.text("driver") == "you drive":
                break
            system.rest(0.05)
        page.run(
            """window.keys = []; window.ghosts = [];
            addEventListener('keydown', (event) => {
              keys.push(performance.timeOrigin + event.timeStamp);
              requestAnimationFrame(() => setTimeout(() => ghosts.push(performance.now() - event.timeStamp), 0));
            }, true);"""
        )
        commands, missed = [], 0
        for k in range(count):
            system.rest(0.6 + 0.013 * (k % 9))
            began_ns = system.clock.now_ns()
            page.key("KeyD" if k % 2 else "KeyA")
            wall, now_ns = utc_seconds(), system.clock.now_ns()
            try:
                moved_ns = system.moves(began_ns, 1.0)
            except AssertionError:
                missed += 1
            else:
                pressed = page.run("return keys.at(-1)") * 1e-3
                commands.append((moved_ns - now_ns) * 1e-9 + wall - pressed)
            page.key("KeyD" if k % 2 else "KeyA", down=False)
        ghosts = [
            each * 1e-3
            for each in page.run(
                "const own = performance.getEntriesByName('ghost').map(m => m.detail); return own.length ? own : ghosts"
            )
        ]
        return {"command": _summary(commands), "missed": missed, "ghost": _summary(ghosts), "load": _load()}


def late(times: int, seconds: float) -> dict[str, Any]:
    """p99 of how late robot loop and controller ticks are, without and with console and recorder."""
    found: dict[str, list[dict[str, float]]] = {"without": [], "with": []}
    for _ in range(times):
        for name, console in (("without", False), ("with", True)):
            with _system(console=console) as system:
                if console:
                    for _ in range(round(seconds / 1.0)):
                        system.press()
                        system.rest(0.6)
                        system.let_go()
                        system.rest(0.4)
                else:
                    system.rest(seconds)
                load = _load()
                result = system.end()
            found[name].append(
                {
                    "robot": result["robot"]["lateness"]["p99"],
                    "controller": result["operator"]["lateness_p99"],
                    "load": load,
                }
            )
    medians = {
        name: {
            what: statistics.median(each[what] for each in rows) for what in ("robot", "controller", "load")
        }
        for name, rows in found.items()
    }
    ratios = {what: medians["with"][what] / medians["without"][what] for what in ("robot", "controller")}
    return {"runs": found, "medians": medians, "ratios": ratios}


class _System:
    """Emulator, robot and operator, which `remote` steers, and perhaps a console with a page that drives."""

    def __init__(self, closing: ExitStack, *, console: bool) -> None:
        self.clock, self._pause = SystemClock(), threading.Event()
        near, far, reports, page = (f"127.0.0.1:{port}" for port in free_ports(4))
        self.folder = Path(closing.enter_context(tempfile.TemporaryDirectory()))
        self.host = page
        self.programs = closing.enter_context(Programs(self.folder))
        start = self.programs.start
        self._netem = start(
            *NetemWords(
                listen_operator=f"tcp/{near}", listen_robot=f"tcp/{far}", network="constant:20"
            ).words()
        )
        self._robot = start(
            *RobotWords(
                scenario="ur5-obstacle",
                robot="ur5",
                connect=(f"tcp/{far}",),
                result=str(self.folder / "robot.json"),
            ).words()
        )
        self._operator = start(
            *OperatorWords(
                scenario="ur5-obstacle",
                settings=("steering.kind=remote",),
                robot="ur5",
                connect=(f"tcp/{near}",),
                report=f"tcp/{reports}",
                result=str(self.folder / "operator.json"),
            ).words()
        )
        if console:
            start(
                *RecordWords(out=str(self.folder / "run.mcap"), connect=f"tcp/{reports}", robot="ur5").words()
            )
        start(*ConsoleWords(connect=f"tcp/{reports}", listen=page, robot="ur5").words()).wait_for("drive at")
        self._decoder = Decoder(VelocityCommand)
        self._link = ZenohLink(
            open_session([f"tcp/{reports}"]), [mirror_key("ur5", "command"), report_key("ur5")], self.clock
        )
        closing.callback(self._link.close)
        self._presses, self._held = 0, False
        self._caller: Caller | None = None
        self._until(lambda: bool(self._link.receive()), 60.0, "the operator's program reports")
        self.rest(2.0)
        if console:
            self._caller = closing.enter_context(Caller(page))
            ended = threading.Event()
            _started(closing, ended, self._drive, ended)
            self.rest(1.5)

    def rest(self, seconds: float) -> None:
        """Wait."""
        self._pause.wait(seconds)

    def press(self) -> int:
        """Press at the console's socket; when it was."""
        assert self._caller is not None
        self._link.receive()
        self._presses += 1
        began_ns = self.clock.now_ns()
        with self._lock:
            self._held = True
            self._steer()
        return began_ns

    def let_go(self) -> None:
        """Let go."""
        with self._lock:
            self._held = False
            self._steer()

    def begin_anew(self) -> None:
        """After a stop that an overloaded machine had the robot latch, or a wheel that it lost."""
        assert self._caller is not None
        with self._lock:
            self._caller.says(kind="do", what="take")
            self._caller.says(kind="do", what="acknowledge")
        self.rest(1.0)

    def moves(self, began_ns: int, patience: float = 2.0) -> int:
        """When the first command with a velocity came after an instant."""
        while self.clock.now_ns() < began_ns + to_ns(patience):
            for packet in self._link.receive():
                told = self._decoder.decode(packet.payload) if packet.key.endswith("command") else None
                moves = told is not None and told.mode == "run" and any(told.velocity)
                if moves and packet.arrived_ns > began_ns:
                    return packet.arrived_ns
            self._pause.wait(0.001)
        raise AssertionError("no command moves")

    def end(self) -> dict[str, Any]:
        """End the programs; what they leave behind."""
        for program in (self._operator, self._robot):
            program.interrupt()
        return {
            name: json.loads((self.folder / f"{name}.json").read_text()) for name in ("robot", "operator")
        }

    def _drive(self, ended: threading.Event) -> None:
        assert self._caller is not None
        self._caller.says(kind="do", what="take")
        listener = threading.Thread(target=_listen, args=(self._caller, ended), daemon=True)
        listener.start()
        while not ended.wait(0.02):
            with self._lock:
                self._steer()

    def _steer(self) -> None:
        assert self._caller is not None
        there = 1.0 if self._presses % 2 else -1.0  # and back: the arm stays where it is free
        self._caller.steer(self.clock.now_ns(), self._held, self._presses, (0.0, there, 0.0))

    def _until(self, holds: Callable[[], bool], patience: float, what: str) -> None:
        deadline_ns = self.clock.now_ns() + to_ns(patience)
        while not holds():
            if self.clock.now_ns() > deadline_ns:
                raise AssertionError(f"not within {patience:g} s: {what}")
            self._pause.wait(0.05)

    _lock = threading.Lock()


@contextmanager
def _system(*, console: bool) -> Iterator[_System]:
    with ExitStack() as closing:
        yield _System(closing, console=console)


def _started(closing: ExitStack, ended: threading.Event, what: Callable[..., None], *args: object) -> None:
    def quiet() -> None:
        try:
            what(*args)
        except Exception:
            if not ended.is_set():
                raise

    thread = threading.Thread(target=quiet, daemon=True)
    thread.start()
    closing.callback(thread.join, 3.0)
    closing.callback(ended.set)


def _load() -> float:
    return os.getloadavg()[0]


def _summary(found: list[float]) -> dict[str, float]:
    if not found:
        return {"count": 0}
    ordered = sorted(found)
    return {
        "count": len(found),
        "median": statistics.median(found),
        "p90": ordered[min(len(ordered) - 1, round(0.9 * len(ordered)))],
        "max": ordered[-1],
    }


def _told(found: dict[str, float]) -> str:
    if not found["count"]:
        return "none"
    return (
        f"median {found['median'] * 1e3:.1f} ms, 90 % within {found['p90'] * 1e3:.1f}, "
        f"at most {found['max'] * 1e3:.1f} ({found['count']:.0f})"
    )


def _lines(found: dict[str, Any]) -> Iterator[str]:
    for name, each in found["share"].items():
        yield f"console, {name:14s} {each['share'] * 100:5.1f} % of a core (at most {SHARE * 100:.0f}){_at(each)}"
    pressed, page = found["press"], found["browser"]
    over = f"{pressed['over']} over {(TICK + BEYOND) * 1e3:.0f} ms, {pressed['missed']} missed"
    yield f"press at the socket to command   {_told(pressed)}; {over}{_at(pressed)}"
    if page is not None:
        yield f"key in Chromium to command       {_told(page['command'])}; {page['missed']} missed{_at(page)}"
        yield f"key in Chromium to drawn ghost   {_told(page['ghost'])} (at most {GHOST_WITHIN * 1e3:.0f})"
    medians = found["late"]["medians"]
    for what, ratio in found["late"]["ratios"].items():
        without, there = (medians[name][what] * 1e3 for name in ("without", "with"))
        yield (
            f"{what:10s} late by p99 {without:.2f} ms without, {there:.2f} ms with a console: {ratio:.2f} "
            f"(at most {LATER}){_at(medians['without'])}{_at(medians['with'])}"
        )


def _at(found: dict[str, float]) -> str:
    return f"   load {found['load']:.1f}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the results here as well")
    parser.add_argument("--quick", action="store_true", help="fewer and shorter, in a minute")
    options = parser.parse_args()
    found = run(options.quick)
    print(*_lines(found), sep="\n")
    if options.json is not None:
        options.json.write_text(json.dumps(found, indent=2), encoding="utf-8")


if __name__ == "__main__":
    main()
