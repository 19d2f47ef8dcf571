"""The page's other hands in a real Chromium: sticks, steps, a gamepad and the keyboard alone; and two dimensions."""

import math

import pytest

from tests.operator_side.console.browser import CHROMIUM, DRIVER
from tests.operator_side.console.desk import NOW, Desk
from tests.operator_side.console.test_page_browser import LETS_GO_WITHIN, LOADED
from tests.operator_side.console.test_page_pictures import AT, DOWN, Ur5

pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(
        not (CHROMIUM and DRIVER), reason="needs Debian's packages chromium and chromium-driver"
    ),
]
PAD = """
window.pad = {id: 'pad', connected: true, axes: [0, 0, 0, 0], rumbled: 0,
  buttons: Array.from({length: 17}, () => ({pressed: false, value: 0})),
  vibrationActuator: {playEffect: async (kind, how) => { window.pad.rumbled = how.strongMagnitude; }}};
navigator.getGamepads = () => [window.pad];
"""
DEADMAN = "window.pad.buttons[5].pressed = {}"


@pytest.fixture(scope="module")
def shared():
    desk = Desk(Ur5())
    yield desk
    desk.close()


@pytest.fixture
def desk(shared):
    shared.operator.state, shared.operator.report = {}, {}
    shared.browser.open("about:blank")
    shared.until(lambda: not shared.console.seat.pages, "no page is left")
    shared.sits_down()
    shared.browser.click("#draw input[value='2d']")
    return shared


def middle(browser, selector):
    return browser.run(
        f"const r = document.querySelector({selector!r}).getBoundingClientRect();"
        "return [r.x + r.width / 2, r.y + r.height / 2]"
    )


def touch(browser, kind, *points):
    points = [{"x": x, "y": y, "id": k} for k, (x, y) in enumerate(points)]
    browser.cdp("Input.dispatchTouchEvent", type=kind, touchPoints=points)


@pytest.fixture
def tab(desk):
    """A tab of its own: after two fingers at once a tab of this Chromium hears no touch of WebDriver any more."""
    desk.browser.open("about:blank")
    desk.until(lambda: not desk.console.seat.pages, "no page is left")
    home, own = desk.browser.tab, desk.browser.new_tab()
    yield desk.sits_down()
    desk.browser.go_to(own)
    desk.browser.close_tab()
    desk.browser.go_to(home)


def pushed(tab, starts, ends, wanted):
    """Both sticks pushed until it is told; again, as a person would, where a busy machine had the page late."""
    for _ in range(8):
        tab.begins(lambda: touch(tab.browser, "touchStart", *starts), lambda: touch(tab.browser, "touchEnd"))
        assert tab.operator.told[-1].linear == (0.0, 0.0, 0.0)
        touch(tab.browser, "touchMove", *ends)
        deadline_ns = tab.operator.clock.now_ns() + 3_000_000_000
        while tab.operator.clock.now_ns() < deadline_ns and tab.engaged:
            if (tab.operator.told[-1].linear, tab.operator.told[-1].angular) == wanted:
                return
            tab.pause.wait(0.005)
        touch(tab.browser, "touchEnd")
        tab.until(lambda: not tab.engaged, "it lets go")
    raise AssertionError(f"no push is heard: {tab.browser.text('sentence')}")


def test_two_sticks_drive_all_the_way_they_are_pushed_and_stop_when_left(tab):
    tab.browser.click("#with-sticks")
    (x, y), (u, v) = (middle(tab.browser, f"[data-stick={name}]") for name in ("move", "turn"))
    pushed(tab, ((x, y), (u, v)), ((x + 90, y), (u - 90, v)), ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)))
    assert tab.lets_go_after(lambda: touch(tab.browser, "touchEnd"), by_page=True) < LETS_GO_WITHIN + LOADED
    tab.stays_still(0.3)


def test_a_stick_that_is_held_while_the_page_lets_go_moves_nothing_after(desk):
    desk.browser.click("#with-sticks")
    x, y = middle(desk.browser, "[data-stick=move]")
    desk.begins(lambda: touch(desk.browser, "touchStart", (x, y)), lambda: touch(desk.browser, "touchEnd"))
    desk.browser.run("window.dispatchEvent(new Event('blur'))")
    desk.until(lambda: not desk.engaged, "it lets go")
    touch(desk.browser, "touchMove", (x, y - 50))
    desk.stays_still(0.4)
    touch(desk.browser, "touchEnd")


def test_a_step_ends_by_itself_and_a_key_that_stays_down_begins_no_other(desk):
    desk.browser.click("#modes input[value=step]")
    desk.operator.report = {"predicted": AT}
    desk.pause.wait(0.2)
    desk.presses("KeyD")
    told = desk.operator.told[-1]
    assert 0.0 < told.scale < 0.2  # it begins no faster than it can end
    desk.operator.report = {"predicted": (AT[0] + 0.01, AT[1], AT[2])}
    desk.until(lambda: not desk.engaged, "the step is done")
    for _ in range(3):
        desk.browser.key("KeyD", repeat=True)
    desk.stays_still(0.3)
    desk.browser.key("KeyD", down=False)
    desk.presses("KeyD")
    desk.browser.key("KeyD", down=False)


def test_a_turning_step_is_measured_as_an_angle(desk):
    desk.browser.click("#modes input[value=step]")
    desk.presses("ArrowLeft")
    half = math.radians(5.0) / 2
    w, x, y, z = math.cos(half), 0.0, 0.0, math.sin(half)
    a, b, c, d = DOWN
    turned = (w * a - x * b - y * c - z * d, w * b + x * a, w * c + z * b, w * d + z * a)
    desk.operator.report = {"predicted_orientation": turned}
    desk.until(lambda: not desk.engaged, "the step is done")
    desk.browser.key("ArrowLeft", down=False)


def presses(desk):
    """Its button engages; again where a busy machine had the page just then late."""
    desk.begins(lambda: desk.browser.run(DEADMAN.format("true")), lambda: rest(desk))


def rest(desk):
    desk.browser.run(DEADMAN.format("false"))
    desk.pause.wait(0.2)


def test_a_gamepad_drives_with_its_deadman_button_rumbles_and_stops_when_unplugged(desk):
    desk.browser.run(PAD)
    desk.pause.wait(0.2)
    desk.browser.run("window.pad.axes = [0, -1, 0, 0]")
    desk.stays_still(0.3)  # no button, no motion
    desk.browser.run("window.pad.axes = [0, 0, 0, 0]")
    desk.pause.wait(0.1)
    presses(desk)
    desk.browser.run("window.pad.axes = [0, -1, 0, 0]")
    desk.until(lambda: desk.operator.told[-1].linear == (0.0, 1.0, 0.0), "the stick is heard")
    desk.operator.report = {"desired": (0.0, 0.2, 0.0), "filtered": (0.0, 0.05, 0.0)}
    desk.until(lambda: abs(desk.browser.run("return window.pad.rumbled") - 0.75) < 1e-6, "it rumbles")
    gone = "navigator.getGamepads = () => [null]"
    assert desk.lets_go_after(lambda: desk.browser.run(NOW + gone), by_page=True) < LETS_GO_WITHIN + LOADED
    desk.until(lambda: "unplugged" in desk.browser.text("sentence"), "it says so")
    desk.browser.run("navigator.getGamepads = () => [window.pad]")  # the button still down
    desk.stays_still(0.4)


def test_a_stick_off_its_middle_refuses_the_press_and_says_so(desk):
    desk.browser.run(PAD)
    desk.pause.wait(0.2)
    desk.browser.run("window.pad.axes = [0.4, 0, 0, 0];" + DEADMAN.format("true"))
    desk.until(lambda: "off its middle" in desk.browser.text("sentence"), "it says why")
    desk.browser.run("window.pad.axes = [0, 0, 0, 0]")
    desk.stays_still(0.3)
    rest(desk)
    presses(desk)


def test_a_hidden_page_hears_no_gamepad(desk):
    desk.browser.run(PAD)
    desk.pause.wait(0.2)
    presses(desk)
    hidden = "Object.defineProperty(document, 'hidden', {value: %s, configurable: true});"
    desk.browser.run(hidden % "true" + "document.dispatchEvent(new Event('visibilitychange'))")
    desk.until(lambda: not desk.engaged, "it lets go")
    desk.browser.run(hidden % "false")
    desk.stays_still(0.4)


def test_a_page_without_focus_says_that_it_reads_no_gamepad_where_there_is_one(desk):
    desk.browser.run("dispatchEvent(new Event('blur'))")
    desk.pause.wait(0.3)
    assert "gamepad" not in desk.browser.text("sentence")  # none is there
    desk.browser.run(PAD)
    desk.until(lambda: "gamepad is not read" in desk.browser.text("sentence"), "it says so")
    desk.browser.run(DEADMAN.format("true"))
    desk.stays_still(0.3)
    desk.browser.run("dispatchEvent(new Event('focus'))")
    desk.until(lambda: "gamepad" not in desk.browser.text("sentence"), "it reads it again")
    desk.stays_still(0.3)  # pressed while nobody read it


def test_it_is_driven_by_the_keyboard_alone_and_everything_has_a_name(desk):
    desk.browser.run("document.querySelector('[data-act=up]').focus()")
    desk.begins(lambda: desk.browser.key("Space"), lambda: desk.browser.key("Space", down=False))
    assert desk.operator.told[-1].linear == (0.0, 0.0, 1.0)
    desk.browser.key("Space", down=False)
    desk.until(lambda: not desk.engaged, "it lets go")
    nameless = desk.browser.run(
        "return [...document.querySelectorAll('button, input, select')].filter(e => e.offsetParent &&"
        " !(e.ariaLabel || e.innerText || e.closest('label')?.innerText)).map(e => e.outerHTML)"
    )
    assert nameless == []
    unseen = desk.browser.run(
        "document.getElementById('seat').focus({focusVisible: true});"
        "return getComputedStyle(document.getElementById('seat')).outlineStyle"
    )
    assert unseen == "solid"


def test_without_webgl_it_draws_in_two_dimensions_and_says_why(desk):
    no_webgl = (
        "const get = HTMLCanvasElement.prototype.getContext; HTMLCanvasElement.prototype.getContext ="
        " function (kind, ...more) { return kind.startsWith('webgl') ? null : get.call(this, kind, ...more); }"
    )
    added = desk.browser.cdp("Page.addScriptToEvaluateOnNewDocument", source=no_webgl)
    try:
        desk.browser.open(desk.url)
        desk.until(lambda: "no WebGL" in desk.browser.text("draw-note"), "it says why")
        desk.until(lambda: desk.browser.text("driver") == "you drive", "it drives")
        assert desk.browser.run("return document.getElementById('view').dataset.draw") == "2d"
        desk.presses()
        desk.browser.key("KeyW", down=False)
    finally:
        desk.browser.cdp("Page.removeScriptToEvaluateOnNewDocument", identifier=added["identifier"])


def test_a_button_lights_up_once_the_robot_applies_what_it_asks_for(desk):
    lit = "return document.querySelector('[data-act=forward]').className"
    desk.operator.state = {"applied_session": 1, "applied_seq": 0}
    desk.presses()
    desk.until(lambda: "heard" in desk.browser.run(lit), "the console has heard it")
    desk.operator.report = {"session": 1, "desired": (0.0, 0.1, 0.0)}
    desk.pause.wait(0.4)
    assert "received" not in desk.browser.run(lit)
    desk.operator.state = {"applied_session": 1, "applied_seq": 2**40}
    desk.until(lambda: "received" in desk.browser.run(lit), "the robot has it")
    desk.browser.key("KeyW", down=False)
    desk.until(lambda: "received" not in desk.browser.run(lit), "it is up")
