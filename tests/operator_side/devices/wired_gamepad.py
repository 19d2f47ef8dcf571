"""`farhand steer gamepad` with SDL's virtual joystick, which does what is said on stdin: `move lefty -1`, `press b`."""

import queue
import sys
import threading

from farhand.operator_side.devices.sdl import SdlSource
from farhand.operator_side.devices.sources import SOURCES
from farhand.programs.steer import SteerOptions, steer_program
from farhand.runs.scenario import load_scenario, replace_settings
from tests.operator_side.devices.virtual_joystick import VirtualJoystick


class Wired(SdlSource):
    """Does what was said, before it is read: all of SDL is of one thread."""

    def __init__(self, name=""):
        super().__init__(name)
        self._stick, self._said = VirtualJoystick(), queue.Queue()
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self):
        for line in sys.stdin:
            self._said.put(line.split())

    def read(self, now_ns):
        while not self._said.empty():
            what, *names = self._said.get()
            if what == "move":
                self._stick.move(**{names[0]: float(names[1])})
            else:
                getattr(self._stick, what)(*names)
        return super().read(now_ns)


if __name__ == "__main__":
    SOURCES["gamepad"] = Wired
    scenario = replace_settings(load_scenario("point-obstacle"), {"steering.kind": "gamepad"})
    sys.exit(steer_program(scenario, SteerOptions(robot="r", connect=sys.argv[1])))
