"""The emulator and the robot's program as processes, and a hand that drives."""

import signal
import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from farhand.common.errors import FarhandError
from farhand.common.link.ports import free_ports
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.trials.ur.hand import Hand

PATIENCE = 60.0
LONGEST = 300.0
"""s that a command may take."""
ROBOT = "ur"
MOVING = 0.15
"""m/s of the tool, from which it counts as driven."""
STOOD = 0.3
"""s."""
SPEED = 0.2
"""m/s, that the hand asks for."""


class Rig:
    """Starts both; `close` ends everything.

    Args:
        folder: for logs.
        address: of loopback, where the emulator listens.
        rate_hz: of the emulated controller.
        settings: of the scenario, as --set has them.
        driven: by a hand; else nobody drives yet, and the robot's program is not started.
    """

    def __init__(
        self,
        folder: Path,
        address: str,
        rate_hz: float = 500.0,
        settings: tuple[str, ...] = (),
        *,
        driven: bool = True,
    ) -> None:
        self._folder, self.address, self.clock = folder, address, SystemClock()
        self._settings = settings
        (port, fault_port) = free_ports(2)
        self.endpoint = f"tcp/127.0.0.1:{port}"
        self.programs: dict[str, subprocess.Popen[bytes]] = {}
        self._faults: socket.socket | None = None
        self.hand: Hand | None = None
        try:
            words = ("--address", address, "--rate", f"{rate_hz:g}", "--scenario", "ur5-obstacle")
            self._start("emulator", "ur", "emulator", *words, "--fault-port", str(fault_port))
            self.wait(lambda: self._reaches(fault_port), "the emulator")
            if not driven:
                return
            self.start_robot()
            self.hand = Hand(self.endpoint, ROBOT, SPEED)
        except BaseException:
            self.close()
            raise

    def start_robot(self, *, connects: bool = False, result: Path | None = None) -> None:
        """Start the robot's program, or start it again, and wait until it says that it is there.

        Args:
            connects: to `endpoint`; else it listens there.
            result: file for its result.
        """
        settings = [word for setting in self._settings for word in ("--set", setting)]
        at = len(self.said("robot"))
        way = "--connect" if connects else "--listen"
        left = ("--result", str(result)) if result is not None else ()
        words = ("--robot", ROBOT, "--host", self.address, way, self.endpoint, *settings, *left)
        self._start("robot", "robot", *words)
        self.wait(lambda: "Ctrl-C ends it" in self.said("robot")[at:], "the robot")

    def start_beside(self, name: str, *words: str) -> None:
        """Start another program of Farhand's, and wait until it says that it is there."""
        self._start(name, *words)
        self.wait(lambda: "Ctrl-C ends it" in self.said(name), name)

    def said(self, program: str) -> str:
        """What a program has said so far."""
        log = self._log(program)
        return log.read_text(errors="replace") if log.exists() else ""

    def fault(self, line: str) -> str:
        """Give the emulator a command; what it says."""
        sock = self._faults
        assert sock is not None
        sock.sendall(f"{line}\n".encode())
        answer = b""
        while not answer.endswith(b"\n"):
            data = sock.recv(65_536)
            if not data:
                raise FarhandError("the emulator is gone")
            answer += data
        return answer.decode().strip()

    def signal(self, number: signal.Signals) -> None:
        """Send the robot's program a signal; the emulator counts from here."""
        self.fault("mark")
        self.programs["robot"].send_signal(number)

    def wait_for_stand(self) -> None:
        """Until the emulated arm stands, and has stood for a while."""
        end_ns = self.clock.now_ns() + to_ns(PATIENCE)
        since_ns: int | None = None
        while since_ns is None or self.clock.now_ns() - since_ns < to_ns(STOOD):
            stands = self.fault("standstill") not in ("moves", "no command yet")
            since_ns = (since_ns or self.clock.now_ns()) if stands else None
            if self.clock.now_ns() > end_ns:
                raise FarhandError(f"the arm still moves after {PATIENCE:g} s")
            self.pause(0.02)

    def moves(self) -> bool:
        """Whether the robot's program says that the tool moves."""
        state = self.hand.state if self.hand is not None else None
        return state is not None and max(map(abs, state.velocity)) > MOVING

    def joints(self) -> list[float]:
        """Where the emulated arm's joints are (rad)."""
        return [float(word) for word in self.fault("status").rpartition(" q ")[2].split()]

    def mode(self) -> str:
        """The robot's mode, as it says itself."""
        return "" if self.hand is None or self.hand.state is None else self.hand.state.mode

    def reason(self) -> str:
        """Why it is in that mode."""
        return "" if self.hand is None or self.hand.state is None else self.hand.state.reason

    def drive(self) -> None:
        """Acknowledge until the arm moves at its speed."""
        hand = self.hand
        assert hand is not None

        def moves() -> bool:
            if self.mode() != "run":
                hand.acknowledge()
            return self.moves()

        self.wait(moves, "the arm to move", 0.3)

    def wait(self, holds: Callable[[], object], what: str, every: float = 0.02) -> None:
        """Until it holds; FarhandError after a minute, or where a program has ended."""
        end_ns = self.clock.now_ns() + to_ns(PATIENCE)
        while not holds():
            for name, program in self.programs.items():
                if program.poll() is not None:
                    raise FarhandError(f"{name} ended while waiting for {what}: {self.said(name)[-500:]}")
            if self.clock.now_ns() > end_ns:
                raise FarhandError(f"waited {PATIENCE:g} s for {what}: {self.mode()}: {self.reason()}")
            self.pause(every)

    def pause(self, seconds: float) -> None:
        """Let time pass."""
        self.clock.sleep_until(self.clock.now_ns() + to_ns(seconds))

    def farhand(self, *words: str) -> int:
        """Run a command of Farhand to its end; its exit code."""
        with self._log(words[0]).open("ab") as log:
            command = [sys.executable, "-m", "farhand", *words]
            return subprocess.run(
                command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, timeout=LONGEST
            ).returncode

    def interrupt(self, program: str) -> None:
        """End a program as Ctrl-C does."""
        found = self.programs.pop(program)
        found.send_signal(signal.SIGINT)
        found.wait(PATIENCE)

    def end(self, program: str) -> None:
        """End a program, whatever it does; harmless when it has ended."""
        found = self.programs.pop(program, None)
        if found is not None:
            if found.poll() is None:
                found.send_signal(signal.SIGCONT)
                found.kill()
            found.wait()

    def close(self) -> None:
        """End everything."""
        if self.hand is not None:
            self.hand.close()
        for name in reversed(list(self.programs)):
            self.end(name)
        if self._faults is not None:
            self._faults.close()

    def _start(self, name: str, *words: str) -> None:
        self.end(name)
        with self._log(name).open("ab") as log:
            command = [sys.executable, "-m", "farhand", *words]
            self.programs[name] = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log)

    def _log(self, name: str) -> Path:
        return self._folder / f"{name}.log"

    def _reaches(self, port: int) -> bool:
        try:
            self._faults = socket.create_connection((self.address, port), 1.0)
        except OSError:
            return False
        self._faults.settimeout(10.0)
        return True
