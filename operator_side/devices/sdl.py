"""Any controller that SDL knows, and any joystick that it does not, by pygame; in one thread, which sends nothing."""

import os
from typing import Any

from farhand.common.errors import InputError
from farhand.operator_side.devices.reading import Reading
from farhand.operator_side.steering.hand.gamepad import KEYS, STICKS

RUMBLE_MS = 200
_FULL = 32767.0
_ENVIRONMENT = {
    "SDL_VIDEODRIVER": "dummy",  # events without a window
    "SDL_AUDIODRIVER": "dummy",
    "SDL_JOYSTICK_ALLOW_BACKGROUND_EVENTS": "1",
    "SDL_NO_SIGNAL_HANDLERS": "1",  # signals are the program's own
    "PYGAME_HIDE_SUPPORT_PROMPT": "1",
}
LACKING = "needs pygame; install it with `pip install 'farhand[gamepad]'`"


class SdlSource:
    """Reads the first device whose name has `name` in it; raises InputError where pygame is not there.

    Args:
        name: part of the device's name; empty: any.
    """

    def __init__(self, name: str = "") -> None:
        self._pygame, self._controller = _start()
        self._wanted = name.lower()
        self._joystick: Any = None
        self._mapped: Any = None
        self._plugged = 0
        self.trouble = ""

    def read(self, now_ns: int) -> Reading | None:
        """See Source."""
        try:
            if self._plugging() and self._joystick is None:
                self._open_first()
            if self._joystick is None:
                return None
            return Reading(
                self._joystick.get_name()[:64] or "unnamed device",
                self._plugged,
                self._inputs(),
                now_ns,
                mapped=self._mapped is not None,
            )
        except self._pygame.error:  # it goes away while it is read
            self._joystick = self._mapped = None
            return None

    def rumble(self, strength: float) -> None:
        """See Source."""
        if self._joystick is None:
            return
        try:
            if strength > 0.0:
                self._joystick.rumble(strength, strength, RUMBLE_MS)
            else:
                self._joystick.stop_rumble()
        except self._pygame.error:
            pass  # it is gone; the next reading says so

    def found(self) -> list[dict[str, object]]:
        """See Source."""
        self._pygame.event.pump()
        rows: list[dict[str, object]] = []
        for index in range(self._pygame.joystick.get_count()):
            joystick = self._pygame.joystick.Joystick(index)
            known = bool(self._controller.is_controller(index))
            rows.append(
                {
                    "name": joystick.get_name(),
                    "kind": "gamepad",
                    "mapping": "SDL" if known else "none",
                    "axes": joystick.get_numaxes(),
                    "buttons": joystick.get_numbuttons(),
                    "hats": joystick.get_numhats(),
                }
            )
        return rows

    def close(self) -> None:
        """See Source."""
        self._joystick = self._mapped = None
        self._controller.quit()
        self._pygame.quit()

    def _plugging(self) -> bool:
        """Whether anything was plugged in or out since the last look; forgets a device that was."""
        changed = False
        for event in self._pygame.event.get():
            changed = changed or event.type in (self._pygame.JOYDEVICEADDED, self._pygame.JOYDEVICEREMOVED)
            gone = event.instance_id if event.type == self._pygame.JOYDEVICEREMOVED else None
            if self._joystick is not None and gone == self._joystick.get_instance_id():
                self._joystick = self._mapped = None
        return changed

    def _open_first(self) -> None:
        for index in range(self._pygame.joystick.get_count()):
            joystick = self._pygame.joystick.Joystick(index)
            if self._wanted in joystick.get_name().lower():
                self._joystick = joystick
                self._plugged += 1
                if self._controller.is_controller(index):
                    self._mapped = self._controller.Controller(index)
                return

    def _inputs(self) -> dict[str, float]:
        joystick, mapped = self._joystick, self._mapped
        found = {f"axis{n}": float(joystick.get_axis(n)) for n in range(joystick.get_numaxes())}
        found |= {f"button{n}": float(joystick.get_button(n)) for n in range(joystick.get_numbuttons())}
        for n in range(joystick.get_numhats()):
            right, up = joystick.get_hat(n)
            found |= {f"hat{n}x": float(right), f"hat{n}y": float(up)}
        if mapped is not None:
            found |= {name: max(-1.0, mapped.get_axis(number) / _FULL) for number, name in enumerate(STICKS)}
            found |= {name: float(mapped.get_button(number)) for number, name in enumerate(KEYS)}
        return found


def _start() -> tuple[Any, Any]:
    for name, value in _ENVIRONMENT.items():
        os.environ.setdefault(name, value)
    try:
        import pygame
        from pygame._sdl2 import controller
    except ImportError:
        raise InputError(f"--steer gamepad: {LACKING}") from None
    pygame.display.init()
    pygame.joystick.init()
    controller.init()
    return pygame, controller
