"""The ports that take programs (primary, secondary, real-time)."""

from farhand.ur_emulator.controller import Controller
from farhand.ur_emulator.functions import WAITS, Functions
from farhand.ur_emulator.program import Program
from farhand.ur_emulator.script_words import ScriptError
from farhand.ur_emulator.sockets import ProgramSockets
from farhand.ur_emulator.urscript import translate
from farhand.ur_emulator.wire import Connection, Handler

LONGEST = 1 << 20
"""Bytes of a program."""


class ScriptHandler(Handler):
    """One client; a program is over where a line without indentation says `end`."""

    def __init__(self, connection: Connection, controller: Controller, sockets: ProgramSockets) -> None:
        super().__init__(connection)
        self._controller, self._sockets = controller, sockets
        self._buffer = b""

    def poll(self, now: float) -> None:
        """Run what has come."""
        self._buffer += self.connection.receive(now)
        if len(self._buffer) > LONGEST:
            self._controller.say("a program of more than 1 MiB is refused")
            self.connection.close()
        while (text := self._whole()) is not None:
            self._run(text)

    def _whole(self) -> str | None:
        """The next whole program; None: not all of it has come."""
        self._buffer = self._buffer.lstrip()
        if not self._buffer.startswith((b"def ", b"sec ")):
            line, newline, rest = self._buffer.partition(b"\n")
            if not newline:
                return None
            self._buffer = rest  # a single line is a program of its own
            return f"def line():\n{line.decode('utf-8', 'replace')}\nend\n"
        at = self._buffer.find(b"\nend\n")
        if at < 0:
            return None
        program, self._buffer = self._buffer[: at + 5], self._buffer[at + 5 :]
        return program.decode("utf-8", "replace")

    def _run(self, text: str) -> None:
        controller = self._controller
        if not controller.remote:
            controller.say("a program is refused: the controller is in local mode")
            return
        if not controller.may_move():
            controller.say("a program is refused: the arm is not ready")
            return
        functions = Functions(controller, self._sockets).table()
        try:
            translation = translate(text, WAITS, functions)
        except ScriptError as error:
            controller.say(f"a program is refused: {error}")
            return
        program = Program(translation, functions)
        if translation.secondary:
            controller.run_secondary(program)
        else:
            controller.start_program(program)
