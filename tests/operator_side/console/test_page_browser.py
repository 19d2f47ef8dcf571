"""The page in a real Chromium: whatever takes it out of a person's hands lets go, and nothing moves by itself after."""

import asyncio
import os
import socket
import threading
from pathlib import Path

import pytest
import uvicorn

from farhand.common.timing.clock import to_ns
from farhand.operator_side.console.console import Console
from farhand.operator_side.console.server import Door, Server, build_of
from tests.operator_side.console.browser import CHROMIUM, DRIVER, Browser
from tests.operator_side.console.operator import Operator

pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(
        not (CHROMIUM and DRIVER), reason="needs Debian's packages chromium and chromium-driver"
    ),
]
LETS_GO_WITHIN = 0.25
LOADED = 0.15  # what a loaded machine may add to it (s)
PATIENCE = 8.0
PICTURES = os.environ.get("FARHAND_PICTURES", "")


class Desk:
    """A console with an operator's program that always answers, served on loopback, and a browser before it."""

    def __init__(self, operator=None, find_model=lambda _: None):
        self.operator, self.pause = operator or Operator(), threading.Event()
        self.bound = socket.create_server(("127.0.0.1", 0))
        host = f"127.0.0.1:{self.bound.getsockname()[1]}"
        door = Door(hosts=frozenset({host}), build=build_of())
        self.console = Console("r", self.operator, 5, find_model)
        server = Server(self.console, door, self.operator.clock.now_ns, lambda line: None)
        config = uvicorn.Config(server.app, log_config=None, ws="websockets-sansio", ws_max_size=4096)
        self.server, self.url = uvicorn.Server(config), f"http://{host}/"
        serve = self.server.serve(sockets=[self.bound])
        self.thread = threading.Thread(target=lambda: asyncio.run(serve), daemon=True)
        self.thread.start()
        self.browser = Browser()

    def until(self, holds, what, patience=PATIENCE):
        deadline_ns = self.operator.clock.now_ns() + to_ns(patience)
        while self.operator.clock.now_ns() < deadline_ns:
            if holds():
                return
            self.pause.wait(0.005)
        raise AssertionError(f"not within {patience:g} s: {what}")

    @property
    def engaged(self):
        return bool(self.operator.told) and self.operator.told[-1].engaged

    def sits_down(self):
        self.browser.open(self.url)
        self.until(lambda: self.browser.text("driver") == "you drive", "the page drives")
        return self

    def presses(self, code="KeyW"):
        self.browser.key(code)
        self.until(lambda: self.engaged, "a press engages")
        return self

    def lets_go_after(self, deed):
        """How long the operator's program was told to move after a deed was done (s)."""
        began = len(self.operator.told)
        done_ns = self.operator.clock.now_ns()
        deed()
        self.until(lambda: not self.engaged, "it lets go")
        told = zip(self.operator.told_ns[began:], self.operator.told[began:], strict=False)
        return (max((at for at, said in told if said.engaged), default=done_ns) - done_ns) * 1e-9

    def stays_still(self, seconds=0.6):
        began = len(self.operator.told)
        self.pause.wait(seconds)
        assert not any(said.engaged for said in self.operator.told[began:])

    def close(self):
        self.browser.close()
        self.server.should_exit = True
        self.thread.join(5)
        self.bound.close()


@pytest.fixture(scope="module")
def shared():
    desk = Desk()
    yield desk
    desk.close()


@pytest.fixture
def desk(shared, request):
    shared.browser.key("KeyW", down=False)
    shared.browser.open("about:blank")
    shared.until(lambda: not shared.console.seat.pages, "no page is left")
    shared.console.seat.stopped()
    shared.sits_down()
    yield shared
    if PICTURES:
        shared.browser.picture(Path(PICTURES) / f"{request.node.name}.png")


def hide(browser):
    browser.cdp("Page.enable")
    browser.run(
        "Object.defineProperty(document, 'hidden', {value: true, configurable: true});"
        "document.dispatchEvent(new Event('visibilitychange'))"
    )


ENDS = {
    "release": lambda browser: browser.key("KeyW", down=False),
    "blur": lambda browser: browser.run("window.dispatchEvent(new Event('blur'))"),
    "hidden": hide,
    "another page": lambda browser: browser.open("about:blank"),
    "frozen": lambda browser: browser.freeze(),
    "emergency stop": lambda browser: browser.key("Escape"),
}


@pytest.mark.parametrize("way", ENDS)
def test_whatever_ends_a_press_lets_go_in_time_and_for_good(desk, way):
    desk.presses()
    try:
        assert desk.lets_go_after(lambda: ENDS[way](desk.browser)) < LETS_GO_WITHIN + LOADED
        desk.stays_still()
    finally:
        desk.browser.freeze(False)
    desk.stays_still()  # awake again, the key still down
    desk.browser.key("KeyW", repeat=True)
    desk.stays_still(0.3)


def test_after_a_frozen_browser_a_fresh_press_drives_on(desk):
    desk.presses()
    desk.browser.freeze()
    desk.until(lambda: not desk.engaged, "it lets go")
    desk.browser.freeze(False)
    desk.browser.key("KeyW", down=False)
    desk.until(
        lambda: desk.browser.text("driver") == "you drive" or desk.browser.click("#seat"), "it drives again"
    )
    desk.presses()


def test_a_key_that_is_held_while_the_page_loads_moves_nothing(desk):
    desk.presses()
    desk.browser.open("about:blank")
    desk.sits_down()
    for _ in range(5):
        desk.browser.key("KeyW", repeat=True)
    desk.stays_still()


def test_a_second_page_watches_and_its_keys_move_nothing(desk):
    first = desk.browser.tab
    second = desk.browser.new_tab()
    try:
        desk.browser.open(desk.url)
        desk.until(lambda: "drives" in desk.browser.text("driver"), "it watches")
        assert desk.browser.text("driver") != "you drive"
        desk.browser.key("KeyW")
        desk.stays_still()
    finally:
        desk.browser.go_to(second)
        desk.browser.close_tab()
        desk.browser.go_to(first)


def test_a_silent_operator_locks_and_a_held_key_is_not_done_later(desk):
    desk.presses()
    desk.operator.silent = True
    try:
        desk.until(lambda: not desk.engaged, "it lets go")
        desk.until(lambda: desk.browser.text("pill").lower() == "link lost", "it says so")
    finally:
        desk.operator.silent = False
    desk.until(lambda: desk.browser.text("pill").lower() != "link lost", "it is back")
    desk.stays_still()


def test_touch_buttons_drive_while_they_are_held(desk):
    spot = desk.browser.run(
        "const r = document.querySelector('[data-act=left]').getBoundingClientRect(); return [r.x + 9, r.y + 9]"
    )
    at = {"x": spot[0], "y": spot[1]}
    desk.browser.cdp("Input.dispatchTouchEvent", type="touchStart", touchPoints=[at])
    desk.until(lambda: desk.engaged, "a touch engages")
    assert desk.operator.told[-1].linear == (-1.0, 0.0, 0.0)
    touch = lambda: desk.browser.cdp("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])  # noqa: E731
    assert desk.lets_go_after(touch) < LETS_GO_WITHIN + LOADED


@pytest.mark.parametrize("size", [(1280, 720), (390, 844)])
def test_everything_fits_and_the_stop_is_in_sight(desk, size):
    width, height = size
    desk.browser.cdp(
        "Emulation.setDeviceMetricsOverride",
        width=width,
        height=height,
        deviceScaleFactor=1,
        mobile=width < 700,
    )
    found = desk.browser.run(
        "const r = document.getElementById('estop').getBoundingClientRect();"
        "const d = document.documentElement;"
        "return [d.scrollWidth <= innerWidth, d.scrollHeight <= innerHeight, r.bottom <= innerHeight, r.height]"
    )
    desk.browser.cdp(
        "Emulation.setDeviceMetricsOverride", width=1280, height=720, deviceScaleFactor=1, mobile=False
    )
    assert found[:3] == [True, True, True]
    assert found[3] >= 60


def test_a_new_page_claims_nothing_that_nobody_measured_or_asked_for(desk):
    assert desk.browser.text("estop").startswith("E-STOP")
    assert desk.browser.text("link") == "–"
    assert "again" not in desk.browser.text("sentence")


def test_a_stop_is_asked_for_until_the_robot_shows_it(desk):
    desk.browser.key("Escape")
    desk.until(lambda: desk.browser.text("pill").lower() == "e-stop", "the pill says so")
    assert "not confirmed" in desk.browser.text("sentence")
    desk.pause.wait(1.5)  # longer than the press itself is shown
    assert desk.browser.text("estop").startswith("Stopping")
    desk.operator.state = {"mode": "estop", "reason": "emergency stop by the console"}
    try:
        desk.until(lambda: desk.browser.text("estop").startswith("LATCHED"), "it is latched")
        assert "Latched by the robot" in desk.browser.text("sentence")
    finally:
        desk.operator.state = {}


def test_nothing_is_loaded_from_outside_and_it_weighs_little(desk):
    found = desk.browser.run(
        "return performance.getEntriesByType('resource').map(e => [e.name, e.encodedBodySize])"
    )
    assert all(name.startswith(desk.url) for name, _ in found)
    assert sum(size for _, size in found) < 1_000_000
