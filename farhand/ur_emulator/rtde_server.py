"""The controller's end of RTDE connections."""

import math
import struct
from collections.abc import Callable

from farhand.robot_side.ur.rtde_codec import (
    DATA,
    IN_USE,
    INPUTS,
    NOT_FOUND,
    OUTPUTS,
    PAUSE,
    START,
    TEXT,
    URCONTROL,
    VERSION,
    BrokenStreamError,
    Package,
    Recipe,
    pack,
    take,
)
from farhand.ur_emulator.controller import Controller
from farhand.ur_emulator.rtde_variables import Getter, input_type, output_of
from farhand.ur_emulator.wire import Connection, Handler

MOST_RECIPES = 255
PROTOCOL = 2


class RtdeHandler(Handler):
    """One client.

    Args:
        connection: to it.
        controller: is asked.
        owners: which handler has set up which input, of all clients: an input has one owner.
    """

    def __init__(
        self, connection: Connection, controller: Controller, owners: "dict[str, RtdeHandler]"
    ) -> None:
        super().__init__(connection)
        self._controller, self._owners = controller, owners
        self._buffer = bytearray()
        self._inputs: dict[int, Recipe] = {}
        self._output: Recipe | None = None
        self._getters: list[Getter] = []
        self._every = 1
        self._started = False
        self._cycle = 0
        self._answers: dict[int, Callable[[bytes], bytes]] = {
            VERSION: self._version,
            URCONTROL: lambda _: struct.pack(">4I", *self._controller.version),
            OUTPUTS: self._set_outputs,
            INPUTS: self._set_inputs,
            START: lambda _: self._start(True),
            PAUSE: lambda _: self._start(False),
        }

    def poll(self, now: float) -> None:
        """Answer what has come."""
        self._buffer += self.connection.receive(now)
        try:
            for package in take(self._buffer):
                self._handle(package, now)
        except (BrokenStreamError, struct.error, UnicodeDecodeError) as error:
            self._controller.say(f"RTDE: a client is let go: {error}")
            self.connection.close()

    def cycle(self, now: float) -> None:
        """Send what the client has asked for, if it is time."""
        self._cycle += 1
        recipe = self._output
        if not self._started or recipe is None or self._cycle % self._every:
            return
        values = [get(self._controller) for get in self._getters]
        self.connection.send(pack(DATA, recipe.pack(values)), now)

    def gone(self) -> None:
        """Its inputs are free again."""
        for name in [name for name, owner in self._owners.items() if owner is self]:
            del self._owners[name]

    def _handle(self, package: Package, now: float) -> None:
        if package.kind == DATA:
            self._take_inputs(package.payload)
            return
        answer = self._answers.get(package.kind)
        if answer is not None:
            self.connection.send(pack(package.kind, answer(package.payload)), now)
        elif package.kind != TEXT:
            raise BrokenStreamError(f"a package of kind {package.kind}")

    def _version(self, payload: bytes) -> bytes:
        (wanted,) = struct.unpack(">H", payload)
        return bytes([wanted == PROTOCOL])

    def _set_outputs(self, payload: bytes) -> bytes:
        (frequency,) = struct.unpack_from(">d", payload)
        if not math.isfinite(frequency):
            raise BrokenStreamError("a frequency that is not finite")
        names = _names(payload[8:])
        found = [output_of(name) for name in names]
        types = [NOT_FOUND if each is None else each[0] for each in found]
        self._output = None
        if NOT_FOUND not in types:
            rate = self._controller.rate_hz
            self._every = max(1, round(rate / min(max(frequency, 1.0), rate)))
            self._getters = [each[1] for each in found if each is not None]
            self._output = Recipe(1, names, types)
        return bytes([self._output is not None]) + ",".join(types).encode()

    def _set_inputs(self, payload: bytes) -> bytes:
        names = _names(payload)
        types = []
        for name in names:
            kind = input_type(name)
            taken = self._owners.get(name, self) is not self
            types.append(NOT_FOUND if kind is None else IN_USE if taken else kind)
        good = not {NOT_FOUND, IN_USE} & set(types) and len(self._inputs) < MOST_RECIPES
        number = len(self._inputs) + 1 if good else 0
        if good:
            self._inputs[number] = Recipe(number, names, types)
            self._owners.update(dict.fromkeys(names, self))
        return bytes([number]) + ",".join(types).encode()

    def _start(self, started: bool) -> bytes:
        self._started = started
        return b"\1"

    def _take_inputs(self, payload: bytes) -> None:
        recipe = self._inputs.get(payload[0]) if payload else None
        if recipe is None:
            raise BrokenStreamError("inputs of a recipe that was not set up")
        values = dict(zip(recipe.names, recipe.unpack(payload), strict=True))
        inputs = self._controller.registers.inputs
        for name, value in values.items():
            if name in inputs and not isinstance(value, (list, tuple)):
                inputs[name] = value  # type: ignore[assignment]
        if values.get("speed_slider_mask"):
            fraction = values.get("speed_slider_fraction", 1.0)
            if isinstance(fraction, float) and 0.0 <= fraction <= 1.0:
                self._controller.set_slider(fraction)
        self._controller.heard(recipe.names)


def _names(payload: bytes) -> list[str]:
    """Of variables; some clients end the list with a comma."""
    return [name for name in payload.decode().split(",") if name]
