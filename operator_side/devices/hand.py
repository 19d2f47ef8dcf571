"""Hold-to-run at a device: from what it shows to what is wanted. A state machine that is told the time.

| what happens | what is wanted |
|---|---|
| deadman pressed, after it was seen released | motion, a new press |
| an input that was off its centre then | nothing by this input until it has been back once |
| deadman released, device unplugged, frozen or another one | zero; a new press is needed |
| no news, or the robot stopped | zero; a new press is needed once that is over |
| emergency stop | estop, while it is pressed and a second more; a new press is needed |
| anything held while the device is plugged in | nothing, but an emergency stop |
"""

from dataclasses import dataclass

import msgspec

from farhand.common.messages.steering import Frame, Steering, unsent
from farhand.operator_side.devices.reading import Reading
from farhand.operator_side.steering.hand.hand_settings import AXES, BUTTONS, CAP, HandSettings
from farhand.operator_side.steering.hand.inputs import shaped

FROZEN_NS = 100_000_000
"""A reading that is older than this counts as none."""
ESTOP_FOR_NS = 1_000_000_000
"""For so long an emergency stop is said again and again; the operator's program goes on until the robot has it."""
GIVES_UP_NS = 5_000_000_000
"""Who holds nothing down for so long gives the wheel up."""
HALF = 0.5


@dataclass(frozen=True, slots=True)
class Obstacles:
    """What keeps a hand from driving; empty: nothing does.

    Attributes:
        lost: there is no news.
        stopped: the robot has latched a stop.
    """

    lost: str = ""
    stopped: str = ""


class Hand:
    """Args:
    settings: what the inputs do.
    kind: what it is called where there is none, such as `gamepad`.

    Attributes:
        drives: whether it has moved something and not given the wheel up since.
        says: for people: what it does, or what it waits for.
        waits_for_release: whether the deadman is down, and nothing but a fresh press can move anything.
    """

    def __init__(self, settings: HandSettings, kind: str) -> None:
        self.drives, self.says, self.waits_for_release = False, "", False
        self._settings, self._kind = settings, kind
        self._axes = {name: settings.inputs(name) for name in AXES}
        self._buttons = {name: settings.inputs(name) for name in BUTTONS}
        self._moving = tuple(dict.fromkeys(name for each in self._axes.values() for name in each.names))
        self._frame: Frame = settings.frame
        self._scale = max((n for n, share in enumerate(settings.scales) if share <= HALF), default=0)
        self._plugged = self._press = 0
        self._armed = False
        self._was: dict[str, bool] = {}
        self._parked: set[str] = set()
        self._estop_ns: int | None = None
        self._held_ns = 0

    @property
    def scale(self) -> float:
        """Share of the speeds in force."""
        return self._settings.scales[self._scale]

    def feel(self, reading: Reading | None, now_ns: int, obstacles: Obstacles) -> Steering:
        """What is wanted at `now_ns`; the instants never go back."""
        if reading is None or now_ns - reading.read_ns > FROZEN_NS:
            return self._without(reading, now_ns)
        if reading.plugged != self._plugged:
            self._let_go()
            self._plugged, self._was = reading.plugged, dict.fromkeys(BUTTONS, True)
        down = {name: self._is_down(name, reading) for name in BUTTONS}
        fresh = {name: down[name] and not self._was[name] for name in BUTTONS}
        self._was = down
        self._choose(fresh)
        acknowledge = fresh["acknowledge"] and not down["estop"] and not obstacles.lost
        if acknowledge:
            self._estop_ns = None
        estop = self._stops(down["estop"], now_ns)
        free = not (estop or obstacles.lost or obstacles.stopped)
        self._arm(reading, down["deadman"] and free, fresh["deadman"])
        wish = unsent(press=self._press, estop=estop, acknowledge=acknowledge)
        if self._armed:
            wish = self._moves(wish, reading)
        self.drives = self.drives or self._armed or acknowledge
        self.waits_for_release = down["deadman"] and free and not self._armed
        self._say(reading, obstacles)
        return self._given_up(wish, now_ns)

    def _without(self, reading: Reading | None, now_ns: int) -> Steering:
        """Nothing is plugged in, or it shows nothing new."""
        if reading is not None:
            self.says = f"{reading.device} is silent; press anew when it is back"
        elif self._plugged:
            self.says = "unplugged; plug it in again, then press anew"
        elif not self.says:
            named = f" named {self._settings.name!r}" if self._settings.name else ""
            self.says = f"no {self._kind}{named} is plugged in; it is found by itself"
        self._let_go()
        self._plugged, self.waits_for_release = 0, False
        release, self.drives = self.drives, False
        return unsent(press=self._press, estop=self._stops(False, now_ns), release=release)

    def _is_down(self, name: str, reading: Reading) -> bool:
        if name == "deadman" and self._settings.held_by_cap:
            return any(self._shaped(each, reading) != 0.0 for each in self._moving)
        return self._buttons[name].value(lambda each: reading.inputs.get(each, 0.0)) > HALF

    def _shaped(self, name: str, reading: Reading) -> float:
        return shaped(reading.inputs.get(name, 0.0), self._settings.dead_zone, self._settings.expo)

    def _choose(self, fresh: dict[str, bool]) -> None:
        """Scale and frame; another frame is another direction, so what was held is let go."""
        step = int(fresh["faster"]) - int(fresh["slower"])
        self._scale = max(0, min(len(self._settings.scales) - 1, self._scale + step))
        if fresh["turn_frame"]:
            self._frame = "tool" if self._frame == "base" else "base"
            self._let_go()

    def _arm(self, reading: Reading, may: bool, fresh: bool) -> None:
        if not may:
            self._let_go()
        elif fresh:
            self._armed = True
            self._press += 1
            if not self._settings.held_by_cap:
                self._parked = {name for name in self._moving if self._shaped(name, reading) != 0.0}

    def _let_go(self) -> None:
        self._armed = False
        self._parked = set()

    def _stops(self, down: bool, now_ns: int) -> bool:
        if down:
            self._estop_ns = now_ns
        if self._estop_ns is not None and now_ns - self._estop_ns > ESTOP_FOR_NS:
            self._estop_ns = None
        return self._estop_ns is not None

    def _moves(self, wish: Steering, reading: Reading) -> Steering:
        values = {name: self._shaped(name, reading) for name in self._moving}
        self._parked = {name for name in self._parked if values[name] != 0.0}

        def value(name: str) -> float:
            return 0.0 if name in self._parked else values[name]

        x, y, z, roll, pitch, yaw = (each.value(value) + 0.0 for each in self._axes.values())

        return msgspec.structs.replace(
            wish,
            engaged=True,
            linear=(x, y, z),
            angular=(roll, pitch, yaw),
            frame=self._frame,
            scale=self.scale,
        )

    def _given_up(self, wish: Steering, now_ns: int) -> Steering:
        """With the release of the wheel, once nothing was held for long."""
        if self._armed or wish.acknowledge or wish.estop:
            self._held_ns = now_ns
        if self.drives and now_ns - self._held_ns > GIVES_UP_NS:
            self.drives = False
            return msgspec.structs.replace(wish, release=True)
        return wish

    def _say(self, reading: Reading, obstacles: Obstacles) -> None:
        deadman = self._settings.deadman
        if self._estop_ns is not None and not obstacles.stopped:
            self.says = "emergency stop asked for"
        elif obstacles.lost:
            self.says = obstacles.lost
        elif obstacles.stopped:
            clears = f"press {self._settings.acknowledge}" if self._settings.acknowledge else "acknowledge it"
            self.says = f"{obstacles.stopped}; {clears}, then press {deadman} anew"
        elif self._armed:
            parked = f"; let go of {', '.join(sorted(self._parked))} once" if self._parked else ""
            self.says = f"{self._frame} frame, speed {self.scale * 100:.0f} %{parked}"
        elif self.waits_for_release:
            self.says = f"{reading.device}: let go of {deadman}, and press anew"
        else:
            self.says = f"{reading.device}: hold {deadman} to move{self._lacking(reading)}"

    def _lacking(self, reading: Reading) -> str:
        """Which inputs the settings name and this device does not have."""
        named = [name for each in (*self._axes.values(), *self._buttons.values()) for name in each.names]
        lacking = [name for name in dict.fromkeys(named) if name not in reading.inputs and name != CAP]
        if not lacking:
            return ""
        return f"; it has no {', '.join(lacking)}: name others in [steering.{self._kind}] (`farhand devices --watch`)"
