"""The page in a real Chromium: whatever takes it out of a person's hands lets go, and nothing moves by itself after."""

import os
from pathlib import Path

import pytest

from farhand.operator_side.console.server import STATIC
from farhand.operator_side.console.sight import FROZEN_AFTER, Sight
from tests.examples import also
from tests.operator_side.console.browser import CHROMIUM, DRIVER
from tests.operator_side.console.desk import NOW, Desk

pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(
        not (CHROMIUM and DRIVER), reason="needs Debian's packages chromium and chromium-driver"
    ),
]
LETS_GO_WITHIN = 0.25
LOADED = 0.15  # what a loaded machine may add to it (s)
PICTURES = os.environ.get("FARHAND_PICTURES", "")


@pytest.fixture(scope="module")
def shared():
    desk = Desk()
    yield desk
    desk.close()


@pytest.fixture
def desk(shared, request):
    shared.browser.key("KeyW", down=False)
    shared.console.seat.robot_shows(estop=True)
    shared.pause.wait(0.1)
    if len(shared.console.seat.pages) != 1 or not shared.sits():
        shared.browser.open("about:blank")
        shared.wire.cut()
        shared.until(lambda: not shared.console.seat.pages, "no page is left")
        shared.sits_down()
    yield shared
    if PICTURES:
        shared.browser.picture(Path(PICTURES) / f"{request.node.name}.png")


def close_the_page(desk):
    desk.browser.close_tab()
    desk.browser.go_to(desk.browser.tabs[0])
    desk.browser.cdp("Page.bringToFront")


def show_another_tab(desk):
    desk.browser.new_tab(in_front=True)


def gone_for_good(desk):
    desk.wire.hold()


ENDS = {
    "release": lambda desk: desk.browser.key("KeyW", down=False),
    "blur": lambda desk: desk.browser.run("window.dispatchEvent(new Event('blur'))"),
    "hidden": show_another_tab,
    "another page": lambda desk: desk.browser.open("about:blank"),
    "page closed": close_the_page,
    "frozen": lambda desk: desk.browser.freeze(),
    "page hangs": lambda desk: desk.browser.hang(1.0),
    "socket lost": lambda desk: desk.wire.cut(),
    "line silent": gone_for_good,
    "emergency stop": lambda desk: desk.browser.key("Escape"),
}
SEEN = ("release", "blur")
"""By the page, which can say when."""


@pytest.mark.parametrize("way", ENDS)
def test_whatever_ends_a_press_lets_go_in_time_and_for_good(desk, way):
    page = desk.browser.tab
    if way == "page closed":
        desk.browser.new_tab(in_front=False)
    desk.presses()
    try:
        assert desk.lets_go_after(lambda: ENDS[way](desk), by_page=way in SEEN) < LETS_GO_WITHIN + LOADED
        desk.stays_still()
    finally:
        desk.browser.freeze(False)
        desk.wire.hold(False)
        if way == "hidden":
            desk.browser.close_tab()
            desk.browser.go_to(page)
            desk.browser.cdp("Page.bringToFront")
    desk.stays_still()  # awake again, the key still down
    desk.browser.key("KeyW", repeat=True)
    desk.stays_still(0.3)


@pytest.mark.parametrize("asleep", [1.3, also(3.0)])
def test_what_is_pressed_while_a_browser_sleeps_is_not_done_when_it_wakes(desk, asleep):
    began = len(desk.operator.told)
    desk.browser.freeze()
    with desk.browser.later("KeyW"):
        desk.pause.wait(asleep)
        desk.browser.freeze(False)
    desk.stays_still()
    assert not any(said.engaged for said in desk.operator.told[began:])


def test_what_is_pressed_on_a_line_that_is_held_up_is_not_done_when_it_goes_on(desk):
    began = len(desk.operator.told)
    desk.wire.hold()
    desk.browser.key("KeyW")
    desk.pause.wait(0.4)
    desk.browser.key("KeyW", down=False)
    desk.pause.wait(0.3)
    desk.wire.hold(False)
    desk.stays_still()
    assert not any(said.engaged for said in desk.operator.told[began:])


def test_a_page_whose_socket_is_lost_comes_back_by_itself_says_so_and_drives_by_a_fresh_press(desk):
    desk.presses()
    desk.wire.cut()
    desk.until(lambda: "Connected again" in desk.browser.text("sentence"), "it says that it is back")
    desk.stays_still()
    desk.browser.key("KeyW", down=False)
    desk.until(lambda: desk.counts() or desk.browser.click("#seat"), "it drives again")
    desk.presses()


def test_a_frozen_camera_lets_go_and_locks_until_it_shows_something_again(desk):
    desk.operator.camera = True
    try:
        desk.presses()
        shown = desk.operator.shown
        desk.until(lambda: desk.operator.shown >= shown + 3, "pictures come")
        desk.operator.camera = False
        began_ns = desk.operator.clock.now_ns()
        desk.until(lambda: not desk.engaged, "it lets go")
        took = (desk.operator.clock.now_ns() - began_ns) * 1e-9
        assert took < FROZEN_AFTER + LETS_GO_WITHIN + LOADED
        desk.until(lambda: "nothing new" in desk.browser.text("sentence"), "it says why")
        desk.operator.camera = True
        desk.until(lambda: not desk.console.seat.locked, "it unlocks")
        desk.stays_still(0.3)
    finally:
        desk.operator.camera = False
        desk.console._sight = Sight()  # it would lock what comes next, until it counts as gone
        desk.browser.open("about:blank")  # and so would this page


GAMEPAD = """
window.pad = {id: 'pad', connected: true, axes: [0, 0, 0, 0], mapping: 'standard', vibrationActuator: null,
  buttons: Array.from({length: 17}, () => ({pressed: false, value: 0}))};
window.reads = 0;
window.plug = pads => navigator.getGamepads = () => { window.reads += 1; return pads(); };
window.plug(() => [window.pad]);
"""
HOLD_IT = "window.pad.buttons[4] = {pressed: true, value: 1};"
REST_IT = "window.pad.buttons[4] = {pressed: false, value: 0}; window.pad.axes = [0, 0, 0, 0];"
PUSH_IT = "window.pad.axes = [0, -1, 0, 0];"


@pytest.fixture
def pad(desk):
    """The page with a gamepad that a script holds; a browser without a head has none."""
    if b"getGamepads" not in (STATIC / "page.js").read_bytes():
        pytest.skip("this page knows no gamepad")
    desk.browser.run(GAMEPAD)
    reads(desk)
    yield desk
    desk.browser.open("about:blank")


def reads(desk):
    """The page has read its gamepad anew: it does where somebody looks, as often as a busy machine lets it."""
    desk.browser.run("window.dispatchEvent(new Event('focus'))")  # what a test before has taken
    seen = desk.browser.run("return window.reads")
    desk.until(lambda: desk.browser.run("return window.reads") >= seen + 2, "it reads the gamepad")


PAD_ENDS = {
    "unplugged": "window.plug(() => [null]);",
    "disconnected": "window.pad.connected = false;",
    "another in its place": "window.pad = {...window.pad, id: 'other'};",
    "deadman let go": "window.pad.buttons[4] = {pressed: false, value: 0};",
}


@pytest.mark.parametrize("way", PAD_ENDS)
def test_a_gamepad_lets_go_when_it_is_gone_or_its_button_is_up(pad, way):
    def let_go():
        pad.browser.run(REST_IT)
        reads(pad)

    def press():
        pad.browser.run(HOLD_IT)
        reads(pad)  # a stick that is off its middle when the button goes down is refused
        pad.browser.run(PUSH_IT)

    pad.begins(press, let_go)
    assert (
        pad.lets_go_after(lambda: pad.browser.run(NOW + PAD_ENDS[way]), by_page=True)
        < LETS_GO_WITHIN + LOADED
    )
    pad.browser.run("window.plug(() => [window.pad]); window.pad.connected = true;")
    pad.stays_still(0.4)


def test_a_stick_that_drifts_moves_nothing_without_its_button(pad):
    pad.browser.run("window.pad.axes = [0.3, -0.4, 0.2, 1];")
    pad.stays_still()
    pad.browser.run(HOLD_IT)  # nor with it, while it is off its middle
    pad.stays_still()


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


def test_a_key_that_is_still_held_after_the_page_hung_is_said_to_count_no_more(desk):
    desk.presses()
    desk.browser.hang(0.7)
    desk.until(lambda: not desk.engaged, "it lets go")
    said = "let go and press anew"
    desk.until(lambda: said in desk.browser.text("sentence"), "it says so")
    desk.pause.wait(3.5)  # longer than what is past is said
    assert desk.browser.text("pill").lower() == "held"
    assert desk.browser.text("sentence").startswith("Let go by itself")
    desk.browser.key("KeyW", down=False)
    desk.until(lambda: desk.browser.text("pill").lower() == "ready", "it is up")


def test_a_second_page_watches_and_its_keys_move_nothing(desk):
    first = desk.browser.tab
    second = desk.browser.new_tab()
    try:
        desk.browser.open(desk.url)
        desk.until(lambda: "drives" in desk.browser.text("driver"), "it watches")
        assert desk.browser.text("driver") != "you drive"
        desk.until(lambda: desk.browser.text("pill").lower() == "watching", "its pill says so")
        go = "const at = name => getComputedStyle(document.querySelector(name)).backgroundColor;"
        ready = "const pill = document.getElementById('pill'); const mine = at('#pill'); pill.dataset.pill = 'ready';"
        assert desk.browser.run(
            f"{go} {ready} const other = at('#pill'); pill.dataset.pill = 'watching'; return mine !== other"
        )
        desk.browser.key("KeyW")
        desk.stays_still()
    finally:
        desk.browser.go_to(second)
        desk.browser.close_tab()
        desk.browser.go_to(first)


NOTES = """
const sentence = document.getElementById('sentence');
window.noted = '';
new MutationObserver(() => window.noted += sentence.innerText).observe(
  sentence, {childList: true, characterData: true, subtree: true});
"""


def test_a_silent_operator_locks_and_a_held_key_is_not_done_later(desk):
    desk.presses()
    desk.operator.silent = True
    try:
        desk.until(lambda: not desk.engaged, "it lets go")
        desk.until(lambda: desk.browser.text("pill").lower() == "link lost", "it says so")
        desk.until(lambda: "Driving is locked" in desk.browser.text("sentence"), "lost, and not only late")
        desk.browser.run(NOTES)  # it is said for some seconds, and a busy browser answers its script seldom
    finally:
        desk.operator.silent = False
    desk.until(
        lambda: "Connected again after" in desk.browser.run("return window.noted"), "it is back, and says so"
    )
    desk.stays_still()


def test_touch_buttons_drive_while_they_are_held(desk):
    spot = desk.browser.run(
        "const r = document.querySelector('[data-act=left]').getBoundingClientRect(); return [r.x + 9, r.y + 9]"
    )
    at = {"x": spot[0], "y": spot[1]}

    def touch(kind, *points):
        desk.browser.cdp("Input.dispatchTouchEvent", type=kind, touchPoints=points)

    desk.begins(lambda: touch("touchStart", at), lambda: touch("touchEnd"))
    assert desk.operator.told[-1].linear == (-1.0, 0.0, 0.0)
    took = desk.lets_go_after(lambda: touch("touchEnd"), by_page=True)
    assert -0.05 < took < LETS_GO_WITHIN + LOADED, took  # the beat before may be the last that moved


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
    desk.until(lambda: desk.browser.text("link") == "–", "no link is told that nobody measured")
    desk.until(lambda: not desk.console._absence.was_lost, "a busy machine's own silence is told no more")
    desk.until(lambda: "again" not in desk.browser.text("sentence"), "it claims no return")


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
