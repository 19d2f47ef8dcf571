"""The dashboard server: a command a line, an answer a line."""

from collections.abc import Callable

from farhand.ur_emulator.controller import Controller, RobotMode, Runtime, SafetyMode
from farhand.ur_emulator.wire import Connection, Handler

GREETING = "Connected: Universal Robots Dashboard Server"
LONGEST_LINE = 4096
_MODES = {
    RobotMode.DISCONNECTED: "DISCONNECTED",
    RobotMode.BOOTING: "BOOTING",
    RobotMode.POWER_OFF: "POWER_OFF",
    RobotMode.POWER_ON: "POWER_ON",
    RobotMode.IDLE: "IDLE",
    RobotMode.BACKDRIVE: "BACKDRIVE",
    RobotMode.RUNNING: "RUNNING",
}
_PROGRAM = {Runtime.PLAYING: "PLAYING", Runtime.PAUSED: "PAUSED"}
_NEEDS_REMOTE = (
    "play", "power on", "power off", "brake release", "unlock protective stop", "restart safety", "load", "stop",
    "pause", "close safety popup",
)  # fmt: skip


class DashboardHandler(Handler):
    """One client; whether it may control is decided when it connects, as by the controller."""

    def __init__(self, connection: Connection, controller: Controller, serial: str, model: str) -> None:
        super().__init__(connection)
        self._controller = controller
        self._buffer = b""
        self._remote = controller.remote
        self._has_remote = controller.version[0] >= 5  # before, there is no such mode
        major, minor, bugfix, build = controller.version
        connection.send(f"{GREETING}\n".encode(), controller.now)
        self._answers: dict[str, Callable[[], str]] = {
            "robotmode": lambda: f"Robotmode: {_MODES[controller.robot_mode]}",
            "safetymode": lambda: f"Safetymode: {self._safety()}",
            "safetystatus": lambda: f"Safetystatus: {self._safety()}",
            "programstate": lambda: f"{_PROGRAM.get(controller.runtime, 'STOPPED')} program.urp",
            "running": lambda: f"Program running: {str(controller.runtime == Runtime.PLAYING).lower()}",
            "is in remote control": self._is_remote,
            "polyscopeversion": lambda: f"URSoftware {major}.{minor}.{bugfix}.{build} (emulated)",
            "version": lambda: f"URSoftware {major}.{minor}.{bugfix}.{build} (emulated)",
            "get serial number": lambda: serial,
            "get robot model": lambda: model,
            "power on": lambda: self._do(controller.power_on, "Powering on"),
            "power off": lambda: self._do(controller.power_off, "Powering off"),
            "brake release": lambda: self._do(controller.release_brakes, "Brake releasing"),
            "unlock protective stop": controller.unlock_protective_stop,
            "close safety popup": lambda: "closing safety popup",
            "close popup": lambda: "closing popup",
            "restart safety": lambda: self._do(controller.power_off, "Restarting safety"),
            "play": lambda: "Starting program" if controller.play() else "Failed to execute: play",
            "pause": lambda: "Pausing program" if controller.pause() else "Failed to execute: pause",
            "stop": lambda: self._do(controller.end_program, "Stopped"),
        }

    def poll(self, now: float) -> None:
        """Answer what has come."""
        self._buffer += self.connection.receive(now)
        if len(self._buffer) > LONGEST_LINE and b"\n" not in self._buffer:
            self.connection.close()
        while b"\n" in self._buffer:
            line, _, self._buffer = self._buffer.partition(b"\n")
            command = line.decode("utf-8", "replace").strip()
            self.connection.send(f"{self._answer(command)}\n".encode(), now)
            if command.lower() in ("quit", "shutdown"):
                self.connection.close()

    def _answer(self, command: str) -> str:
        word = command.lower()
        if word == "quit":
            return "Disconnected"
        if word.startswith("popup"):
            return "showing popup"
        answer = self._answers.get(word)
        if answer is None:
            return f"could not understand: '{command}'"
        if word in _NEEDS_REMOTE and self._has_remote and not (self._remote and self._controller.remote):
            return f'Command is not allowed due to safety reasons: "{word}" needs remote control'
        return answer()

    def _is_remote(self) -> str:
        if not self._has_remote:
            return "could not understand: 'is in remote control'"
        return str(self._remote).lower()

    def _safety(self) -> str:
        return SafetyMode(self._controller.safety_mode).name

    @staticmethod
    def _do(action: Callable[[], None], said: str) -> str:
        action()
        return said
