"""SDL's virtual joystick, through the SDL that pygame brings: for all that reads it, it is a gamepad."""

import ctypes

SDL_GAMECONTROLLER = 1
AXES = ("leftx", "lefty", "rightx", "righty", "lefttrigger", "righttrigger")
BUTTONS = (
    *(
        "a",
        "b",
        "x",
        "y",
        "back",
        "guide",
        "start",
        "leftstick",
        "rightstick",
        "leftshoulder",
        "rightshoulder",
    ),
    *("dpup", "dpdown", "dpleft", "dpright"),
)


def _sdl():
    import pygame  # noqa: F401  so that its SDL is loaded

    with open("/proc/self/maps") as maps:
        path = next(line.split()[-1] for line in maps if "libSDL2-2" in line)
    sdl = ctypes.CDLL(path)
    sdl.SDL_JoystickOpen.restype = ctypes.c_void_p
    return sdl


class VirtualJoystick:
    """A gamepad that can be plugged in and out, once SDL's joysticks are started."""

    def __init__(self, kind=SDL_GAMECONTROLLER):
        self._sdl, self._kind = _sdl(), kind
        self.plug()

    def plug(self):
        self._index = self._sdl.SDL_JoystickAttachVirtual(self._kind, len(AXES), len(BUTTONS), 0)
        assert self._index >= 0
        self._joystick = ctypes.c_void_p(self._sdl.SDL_JoystickOpen(self._index))
        self._id = self._sdl.SDL_JoystickInstanceID(self._joystick)
        for name in AXES[4:]:
            self.move(**{name: -1.0})  # a trigger that nobody pulls

    def unplug(self):
        if self._joystick is not None:
            self._joystick = None
            ids = [self._sdl.SDL_JoystickGetDeviceInstanceID(n) for n in range(self._sdl.SDL_NumJoysticks())]
            assert self._sdl.SDL_JoystickDetachVirtual(ids.index(self._id)) == 0

    def move(self, **axes):
        for name, value in axes.items():
            number = ctypes.c_int16(round(value * 32767))
            assert self._sdl.SDL_JoystickSetVirtualAxis(self._joystick, AXES.index(name), number) == 0

    def press(self, *names, down=1):
        for name in names:
            assert self._sdl.SDL_JoystickSetVirtualButton(self._joystick, BUTTONS.index(name), down) == 0

    def release(self, *names):
        self.press(*names, down=0)
