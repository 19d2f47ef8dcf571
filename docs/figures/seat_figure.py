"""Draws docs/figures/seat.png: `python docs/figures/seat_figure.py [FOLDER]`; needs Chromium.

A hand drives a UR5 at the ball in virtual time, over a bad network: all messages are those of the real nodes. They are
played to a console and a page in Chromium, with the same keys down, until the instant that is shown. With FOLDER, the
light theme, two dimensions and the phone go there as well.
"""

import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import msgspec

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from farhand.common.link.link import Packet
from farhand.common.messages.camera import CameraFrame
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.keys import kind_of, mirror_key, report_key
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.common.recording.reader import read_run
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.laboratory.simulation import START_NS, simulate_run
from farhand.netem.models.profiles import PROFILES
from farhand.operator_side.console.network import NetworkTold
from farhand.operator_side.steering.device import SteeringDevice, SteeringInput, View
from farhand.operator_side.steering.registry import DEVICES
from farhand.programs.console import _find_model
from farhand.robot_side.camera.camera_node import encoder
from farhand.robot_side.camera.settings import pictures
from farhand.robot_side.camera.source import Seen
from farhand.robot_side.camera.strip import draw_strip
from farhand.robot_side.camera.view import BulletView
from farhand.runs.run import Run
from farhand.runs.scenario import load_scenario, replace_settings
from tests.operator_side.console.desk import Desk

NETWORK, SPEED = "uniform:50,200", 0.15
SHOWN = 11.4
"""The instant that is shown (s)."""
KEYS = {"KeyA": (-1.0, 0.0, 0.0), "KeyD": (1.0, 0.0, 0.0), "KeyQ": (0.0, 0.0, -1.0), "KeyW": (0.0, 1.0, 0.0)}
HELD = ((6.0, 7.25, ("KeyA",)), (7.4, 7.52, ("KeyQ",)), (7.8, 10.3, ("KeyW",)), (10.8, 60.0, ("KeyD",)))
"""From, to (s), and what is held down."""
PICTURES_HZ = 10.0
MESSAGES: dict[str, Any] = {"state": RobotState, "scene": Scene, "description": RobotDescription}
STAMPS = ("t_sent_ns", "t_sample_ns", "t_captured_ns")


def keys_at(seconds: float) -> tuple[str, ...]:
    """What is held down."""
    return next((keys for since, until, keys in HELD if since <= seconds < until), ())


class Hand(SteeringDevice):
    """Holds the keys down, one after the other."""

    rate_hz = 50.0

    def read(self, view: View) -> SteeringInput:
        """See SteeringDevice."""
        keys = keys_at((view.now_ns - START_NS) * 1e-9)
        wanted = [sum(KEYS[key][k] for key in keys) * SPEED for k in range(3)]
        return SteeringInput((wanted[0], wanted[1], wanted[2]), engaged=bool(keys))


class Played:
    """The run as a console hears it: from the beginning to SHOWN, then that instant again and again."""

    def __init__(self, folder: Path) -> None:
        if "picture" not in DEVICES:
            DEVICES.add("picture", Hand)
        scenario = replace_settings(load_scenario("ur5-obstacle"), {"steering.kind": "picture"})
        run = msgspec.structs.replace(Run.over(scenario, NETWORK, seed=3), time_limit=SHOWN + 1.0)
        simulate_run(run, record_to=folder / "run.mcap")
        self.clock, self._began_ns = SystemClock(), None
        self._limit = scenario.controller.d_min
        self._told: list[tuple[int, str, Any]] = sorted(
            [each for tick in read_run(folder / "run.mcap").ticks for each in self._of(tick)],
            key=lambda each: each[0],
        )
        self._told += self._filmed(scenario)
        self._told.sort(key=lambda each: each[0])
        self._next = self._seq = self._held_ns = 0
        self._newest: dict[str, Any] = {}
        self.told: list[Any] = []

    def _of(self, tick: Any):
        for key, arrived_ns, payload in tick.packets:
            kind = kind_of(key)
            yield arrived_ns, kind, Decoder(MESSAGES[kind]).decode(payload)
        if tick.command is not None:
            yield tick.now_ns, "command", Decoder(VelocityCommand).decode(tick.command)
        report = Decoder(ControlReport).decode(tick.report)
        yield tick.now_ns, "report", msgspec.structs.replace(report, limit=self._limit, recording=True)

    def _filmed(self, scenario):
        """What a camera beside the robot would have sent, as late as the states are."""
        size = pictures("320x240", PICTURES_HZ, 80)
        view, compress = BulletView(scenario.robot, scenario.camera, size), encoder()
        scene, due, found = None, 0, []
        for at_ns, kind, message in self._told:
            scene = message if kind == "scene" else scene
            if kind != "state" or at_ns < due:
                continue
            due = at_ns + to_ns(1.0 / PICTURES_HZ)
            shot = view.shoot(Seen(message, at_ns, scene))
            if shot is None:
                continue
            draw_strip(shot.picture, shot.t_captured_ns)
            frame = CameraFrame(
                source="r", session=9, seq=len(found), t_sent_ns=at_ns, camera=view.name,
                robot_session=shot.robot_session, t_captured_ns=shot.t_captured_ns, width=320, height=240,
                jpeg=compress(shot.picture, size.quality),
            )  # fmt: skip
            found.append((at_ns, "camera", frame))
        view.close()
        return found

    def begin(self) -> None:
        """From the beginning."""
        self._began_ns, self._next = None, 0

    @property
    def seconds(self) -> float:
        """Of the run, that have been played."""
        return 0.0 if self._began_ns is None else (self.clock.now_ns() - self._began_ns) * 1e-9

    def send(self, packet: Packet) -> None:
        """Steering, which the run has had already."""

    def receive(self) -> list[Packet]:
        """What has come by now."""
        now_ns = self.clock.now_ns()
        self._began_ns = self._began_ns or now_ns
        past = now_ns - self._began_ns
        until, self._held_ns = START_NS + min(past, to_ns(SHOWN)), max(0, past - to_ns(SHOWN))
        while self._next < len(self._told) and self._told[self._next][0] <= until:
            _, kind, message = self._told[self._next]
            self._newest[kind] = message
            self._next += 1
        self._seq += 1
        return [Packet(*self._now(kind, message), now_ns) for kind, message in self._newest.items()]

    def _now(self, kind: str, message: Any) -> tuple[str, bytes]:
        """The message under its key; at the instant that stays all clocks stand still, as if it were new each time."""
        echo = message.echo
        if echo is not None:
            echo = msgspec.structs.replace(echo, t_sent_ns=echo.t_sent_ns + self._held_ns)
        moved = {name: getattr(message, name) + self._held_ns for name in STAMPS if hasattr(message, name)}
        told = msgspec.structs.replace(message, seq=self._seq, echo=echo, **moved)
        return report_key("r") if kind == "report" else mirror_key("r", kind), encode(told)


class Offered:
    """The emulated network as the demo's menu has it."""

    def told(self) -> NetworkTold:
        """See Network."""
        return NetworkTold((NETWORK, *PROFILES), NETWORK, NETWORK)

    def choose(self, name: str) -> None:
        """See Network."""

    def cut(self, seconds: float) -> None:
        """See Network."""


def main() -> None:
    """The page that is slowed beside the ball."""
    more = Path(sys.argv[1]) if len(sys.argv) > 1 else None
    with ExitStack() as closing:
        played = Played(Path(closing.enter_context(tempfile.TemporaryDirectory())))
        desk = Desk(played, _find_model, Offered())
        closing.callback(desk.close)
        desk.browser.cdp(
            "Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}]
        )
        desk.sits_down()
        for _ in range(6):
            play(desk, played)
            if take(desk, (more or Path(__file__).parent) / "seat.png", "3d", tries=3):
                break
        else:
            raise AssertionError(f"it is not slowed: {desk.browser.text('sentence')}")
        if more is not None:
            take_more(desk, more)


def play(desk: Desk, played: Played) -> None:
    """From the beginning to the instant, with the keys down; in two dimensions, which is quicker."""
    page, down = desk.browser, ()
    page.click("#draw input[value='2d']")
    played.begin()
    while played.seconds < SHOWN - 0.3:
        wanted = keys_at(played.seconds)
        for key in {*down, *wanted}:
            if (key in down) != (key in wanted):
                page.key(key, down=key in wanted)
        down = wanted
        desk.pause.wait(0.05)


def take(desk: Desk, path: Path, how: str, tries: int = 40) -> bool:
    """Whether the page showed the instant; without a GPU it is slow, and lets go of keys by itself."""
    page = desk.browser
    pill = "document.getElementById('pill').innerText.toLowerCase()"
    shows = f"return [{pill}, document.getElementById('camera').dataset.look]"
    for _ in range(tries):
        for each in ("2d", how):  # anew: three dimensions that stay slow are drawn coarser
            page.click(f"#draw input[value='{each}']")
        page.key("KeyD", down=False)
        page.key("KeyD")
        desk.pause.wait(0.8)
        seen = page.run(shows)
        taken = path.with_suffix(".new.png")
        page.picture(taken)
        if seen == page.run(shows) == ["slowed", "fresh"]:
            taken.replace(path)
            return True
        taken.unlink()
    return False


def take_more(desk: Desk, folder: Path) -> None:
    """The same in two dimensions, in the light theme, and on a phone."""
    page = desk.browser
    for name, (width, height) in {"desk": (1280, 720), "phone": (390, 844)}.items():
        page.cdp(
            "Emulation.setDeviceMetricsOverride",
            width=width, height=height, deviceScaleFactor=1, mobile=width < 700,
        )  # fmt: skip
        page.run(f"document.getElementById('with-{'sticks' if width < 700 else 'buttons'}').click()")
        for theme in ("dark", "light"):
            features = [{"name": "prefers-color-scheme", "value": theme}]
            page.cdp("Emulation.setEmulatedMedia", features=features)
            for how in ("2d", "3d"):
                take(desk, folder / f"seat-{name}-{theme}-{how}.png", how)


if __name__ == "__main__":
    main()
