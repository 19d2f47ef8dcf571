"""What goes wrong on command: a line each, from the emulator's terminal, its port for faults, or `--then`."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from farhand.common.errors import InputError
from farhand.ur_emulator.controller import Controller
from farhand.ur_emulator.wire import Connection, Handler, Wire

STANDS_FOR = 0.3
"""s, from which the arm counts as having stood."""
LATEST = 1e6
"""s, to which a command may be put off."""


class Fault(NamedTuple):
    """A command: what it takes and what it does, for people, and how it is done with what it takes."""

    takes: str
    does: str
    act: Callable[[str], str]


class Watch:
    """Measures how long the arm moves on after a command.

    Args:
        since: when that was (s).

    Attributes:
        stands: for how long it has moved on, where it stands now; None: it moves (s).
        first: the same of the first time that it stood for STANDS_FOR, whatever came later; None: it has not (s).
    """

    def __init__(self, since: float) -> None:
        self._since = since
        self.stands: float | None = None
        self.first: float | None = None

    def look(self, moves: bool, now: float) -> None:
        """How it is in one cycle."""
        after = now - self._since
        if moves:
            self.stands = None
        elif self.stands is None:
            self.stands = after
        if self.first is None and self.stands is not None and after - self.stands >= STANDS_FOR:
            self.first = self.stands


class FaultCommands:
    """The commands, on one controller.

    Args:
        controller: what fails.
        wire: its cable.
        hang_up: ends all connections.

    Attributes:
        commands: by their words.
    """

    def __init__(self, controller: Controller, wire: Wire, hang_up: Callable[[], None]) -> None:
        self._controller, self._wire, self._hang_up = controller, wire, hang_up
        self._waiting: list[tuple[float, str]] = []
        self._watch: Watch | None = None
        do = self._simply
        self.commands: dict[str, Fault] = {
            "protective-stop": Fault(
                "", "the arm stops as after a collision", do(lambda: controller.protective_stop("commanded"))
            ),
            "unlock": Fault(
                "", "clears it, 5 s after at the earliest", lambda _: controller.unlock_protective_stop()
            ),
            "estop": Fault("", "the red button is pressed", do(lambda: controller.emergency_stop(True))),
            "estop-release": Fault(
                "", "it is let go; the arm has no power then", do(lambda: controller.emergency_stop(False))
            ),
            "safeguard-open": Fault(
                "", "somebody opens the cell's door", do(lambda: controller.safeguard(True))
            ),
            "safeguard-close": Fault("", "it is closed", do(lambda: controller.safeguard(False))),
            "local": Fault("", "the pendant takes local control; the program ends", self._local),
            "remote": Fault("", "it gives control to the network again", self._remote),
            "freedrive": Fault(
                "", "the arm is led by hand; the program pauses", do(lambda: controller.freedrive(True))
            ),
            "freedrive-end": Fault("", "it is let go", do(lambda: controller.freedrive(False))),
            "pause": Fault("", "somebody presses pause at the pendant", do(controller.pause)),
            "play": Fault("", "somebody presses play", do(controller.play)),
            "stop": Fault("", "somebody presses stop", do(controller.end_program)),
            "slider": Fault("FRACTION", "speed slider, 0 to 1", self._slider),
            "power-off": Fault("", "the arm loses its power", do(controller.power_off)),
            "power-on": Fault("", "power on, brakes released", do(controller.release_brakes)),
            "restart": Fault("", "the controller starts anew: 3 s, then without power", self._restart),
            "cut": Fault("", "the network cable is out", self._cut),
            "plug": Fault("", "it is in again", self._plug),
            "latency": Fault("SECONDS", "of the cable, each way", self._latency),
            "payload": Fault("KG", "somebody sets another payload at the pendant", self._payload),
            "status": Fault("", "says how it is", lambda _: self._status()),
            "standstill": Fault(
                "", "says how long the arm moved on after the last command", lambda _: self._standstill()
            ),
            "stood": Fault(
                "",
                f"says after how long it first stood, for {STANDS_FOR:g} s, whatever came later",
                lambda _: self._first_stood(),
            ),
            "mark": Fault("", "nothing, but standstill counts from here", do(lambda: None)),
            "after": Fault("SECONDS COMMAND", "does COMMAND later", self._after),
            "help": Fault("", "says this", lambda _: self._help()),
        }

    def handler(self, connection: Connection) -> Handler:
        """Of a connection to the port for faults."""
        return FaultHandler(connection, self)

    def check(self, line: str) -> None:
        """Raise InputError where this is no command."""
        word, _, rest = line.strip().partition(" ")
        if word not in self.commands:
            raise InputError(f"--then {line!r}: no such command; there are {', '.join(self.commands)}")
        if bool(rest.strip()) != bool(self.commands[word].takes):
            raise InputError(f"--then {line!r}: expected {word} {self.commands[word].takes}".rstrip())
        if word == "after":
            seconds, _, later = rest.strip().partition(" ")
            if _number(seconds, 0.0, LATEST) is None:
                raise InputError(f"--then {line!r}: expected seconds and a command, such as after 2 cut")
            self.check(later)

    def do(self, line: str) -> str:
        """Do one; what is said of it."""
        word, _, rest = line.strip().partition(" ")
        fault = self.commands.get(word)
        if fault is None:
            return f"{word!r}: no such command; there are {', '.join(self.commands)}"
        rest = rest.strip()
        if bool(rest) != bool(fault.takes):
            return f"{word}: expected {word} {fault.takes}".rstrip()
        said = fault.act(rest)
        if word not in ("status", "standstill", "stood", "help", "after"):
            self._watch = Watch(self._controller.now)
        return said

    def cycle(self) -> None:
        """Do what is due, and look whether the arm stands."""
        controller = self._controller
        for due, line in [each for each in self._waiting if each[0] <= controller.now]:
            self._waiting.remove((due, line))
            controller.say(f"{line}: {self.do(line)}")
        if self._watch is not None:
            self._watch.look(controller.moves, controller.now)

    def time_now(self) -> float:
        """The controller's (s)."""
        return self._controller.now

    @staticmethod
    def _simply(action: Callable[[], object]) -> Callable[[str], str]:
        def act(_: str) -> str:
            action()
            return "done"

        return act

    def _local(self, _: str) -> str:
        self._controller.remote = False
        self._controller.end_program()
        return "done"

    def _remote(self, _: str) -> str:
        self._controller.remote = True
        return "done"

    def _slider(self, word: str) -> str:
        fraction = _number(word, 0.0, 1.0)
        if fraction is None:
            return f"slider {word!r}: expected 0 to 1"
        self._controller.set_slider(fraction)
        return "done"

    def _restart(self, _: str) -> str:
        self._controller.boot()
        self._hang_up()
        return "done"

    def _cut(self, _: str) -> str:
        self._wire.cut = True
        return "done"

    def _plug(self, _: str) -> str:
        self._wire.cut = False
        return "done"

    def _latency(self, word: str) -> str:
        seconds = _number(word, 0.0, 10.0)
        if seconds is None:
            return f"latency {word!r}: expected 0 to 10, in s"
        self._wire.latency = seconds
        return "done"

    def _payload(self, word: str) -> str:
        mass = _number(word, 0.0, 30.0)
        if mass is None:
            return f"payload {word!r}: expected 0 to 30, in kg"
        self._controller.payload = mass
        return "done"

    def _after(self, rest: str) -> str:
        word, _, line = rest.partition(" ")
        seconds = _number(word, 0.0, LATEST)
        if seconds is None or line.split(" ")[0] not in self.commands:
            return f"after {rest!r}: expected seconds and a command, such as after 2 protective-stop"
        self._waiting.append((self._controller.now + seconds, line))
        return "done"

    def _status(self) -> str:
        c = self._controller
        speed = float(np.abs(c.physics.qd).max())
        return (
            f"robot {c.robot_mode.name}, safety {c.safety_mode.name}, program {c.runtime.name}, "
            f"{'remote' if c.remote else 'local'}, slider {c.slider:g}, payload {c.payload:g} kg, "
            f"fastest joint {speed:.4f} rad/s, q {' '.join(f'{each:.6f}' for each in c.physics.q)}"
        )

    def _standstill(self) -> str:
        if self._watch is None:
            return "no command yet"
        stands = self._watch.stands
        return "moves" if stands is None else f"{stands:.3f} s"

    def _first_stood(self) -> str:
        first = self._watch.first if self._watch is not None else None
        return "it has not stood" if first is None else f"it stood after {first:.3f} s"

    def _help(self) -> str:
        return "; ".join(
            f"{f'{word} {each.takes}'.rstrip()}: {each.does}" for word, each in self.commands.items()
        )


class FaultHandler(Handler):
    """A connection to the port for faults: a command a line, an answer a line."""

    def __init__(self, connection: Connection, commands: FaultCommands) -> None:
        super().__init__(connection)
        self._commands = commands
        self._buffer = b""

    def poll(self, now: float) -> None:
        """Do what has come."""
        self._buffer += self.connection.receive(now)
        while b"\n" in self._buffer:
            line, _, self._buffer = self._buffer.partition(b"\n")
            said = self._commands.do(line.decode("utf-8", "replace"))
            self.connection.send(f"{said}\n".encode(), now)
        if len(self._buffer) > 4096:
            self.connection.close()


def _number(word: str, low: float, high: float) -> float | None:
    try:
        value = float(word)
    except ValueError:
        return None
    return value if math.isfinite(value) and low <= value <= high else None
