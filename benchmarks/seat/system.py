"""The real programs on loopback, and a page as the console hears one."""

import json
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from benchmarks.seat.threads import listen, started
from farhand.common.link.link import Packet
from farhand.common.link.ports import free_ports
from farhand.common.link.zenoh_link import ZenohLink, open_session
from farhand.common.messages.codec import Decoder
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.keys import mirror_key, report_key
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.programs.command_line import (
    CameraWords,
    ConsoleWords,
    NetemWords,
    OperatorWords,
    RecordWords,
    RobotWords,
)
from farhand.testing import Programs
from tests.operator_side.console.caller import Caller


class System:
    """Emulator, robot and operator, which `remote` steers; and, where asked for, what people have beside them.

    Args:
        closing: what ends all of it.
        console: with a page that drives, and a recorder.
        camera: with the simulated one, on an endpoint of its own at the robot.
        served: with the console's program.
    """

    def __init__(self, closing: ExitStack, *, console: bool, camera: bool, served: bool) -> None:
        self.clock, self._pause = SystemClock(), threading.Event()
        near, far, reports, page, beside = (f"127.0.0.1:{port}" for port in free_ports(5))
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
                listen=(f"tcp/{beside}",) if camera else (),
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
        if camera:
            eyes = (f"tcp/{beside}", f"tcp/{far}")
            seen = CameraWords(camera="pybullet", scenario="ur5-obstacle", robot="ur5", connect=eyes)
            start(*seen.words())
        if served:
            words = ConsoleWords(connect=f"tcp/{reports}", listen=page, robot="ur5").words()
            start(*words).wait_for("drive at")
        self._decoder = Decoder(VelocityCommand)
        self._link = ZenohLink(
            open_session([f"tcp/{reports}"]),
            [mirror_key("ur5", "command"), report_key("ur5"), mirror_key("ur5", "camera")],
            self.clock,
        )
        closing.callback(self._link.close)
        self._presses, self._held = 0, False
        self._caller: Caller | None = None
        self.pictures = 0
        self._until(lambda: bool(self._heard()), 60.0, "the operator's program reports")
        if camera:
            self._until(lambda: bool(self._heard() and self.pictures), 60.0, "the camera shows something")
        self.rest(2.0)
        if console:
            self._caller = closing.enter_context(Caller(page))
            ended = threading.Event()
            started(closing, ended, self._drive, ended)
            self.rest(1.5)

    def rest(self, seconds: float) -> None:
        """Wait."""
        self._pause.wait(seconds)

    def press(self) -> int:
        """Press at the console's socket; when it was."""
        assert self._caller is not None
        self._heard()
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
            for packet in self._heard():
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

    def _heard(self) -> list[Packet]:
        """What has come; pictures are counted."""
        found = self._link.receive()
        self.pictures += sum(packet.key.endswith("camera") for packet in found)
        return found

    def _drive(self, ended: threading.Event) -> None:
        assert self._caller is not None
        self._caller.says(kind="do", what="take")
        listener = threading.Thread(target=listen, args=(self._caller, ended), daemon=True)
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
def system_of(*, console: bool, camera: bool = False, served: bool = True) -> Iterator[System]:
    with ExitStack() as closing:
        yield System(closing, console=console, camera=camera, served=served)
