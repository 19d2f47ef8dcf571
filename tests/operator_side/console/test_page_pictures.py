"""The page in each of its states, at both sizes and in both themes: all is in sight, and it says which state it is.

With FARHAND_PICTURES=DIR each is kept as a picture, for people to look at.
"""

import os
from pathlib import Path

import pytest

from farhand.common.link.link import Packet
from farhand.common.messages.codec import encode
from farhand.common.messages.keys import mirror_key, report_key
from farhand.common.messages.scene import Obstacle
from farhand.programs.console import _find_model
from farhand.testing import command, description, report, scene, state
from tests.operator_side.console.browser import CHROMIUM, DRIVER
from tests.operator_side.console.desk import Desk
from tests.operator_side.console.operator import Operator

pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(
        not (CHROMIUM and DRIVER), reason="needs Debian's packages chromium and chromium-driver"
    ),
]
PICTURES = os.environ.get("FARHAND_PICTURES", "")
SIZES = {"desk": (1280, 720), "phone": (390, 844)}
JOINTS = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
HOME = (-0.85369, -1.35254, 1.66821, -1.88646, -1.5708, -0.85369)
DOWN = (0.0, 1.0, 0.0, 0.0)
AT, AHEAD = (0.45, -0.35, 0.30), (0.45, -0.30, 0.31)
ASKED = (0.0, 0.15, 0.0)
MARGIN = {
    "inflation": 0.024,
    "margin_parts": {"floor": 0.01, "innovation": 0.019, "spread": 0.004, "lag": 0.005},
    "rtt_mean": 0.412,
    "rtt_std": 0.018,
    "binding": "ball",
    "clearance": 0.051,
}
PLAN = tuple((0.0, 0.12 - 0.01 * k, 0.04 - 0.008 * k) for k in range(12))
STATES = {
    "ready": ({}, {}),
    "run": ({"velocity": ASKED}, {"desired": ASKED, "filtered": ASKED, "binding": ""}),
    "slowed": (
        {"velocity": (0.0, 0.05, 0.02)},
        {"desired": ASKED, "filtered": (0.0, 0.05, 0.03), "intervening": True},
    ),
    "held": ({}, {"desired": ASKED, "intervening": True, "free_side": "above"}),
    "stopped": ({"mode": "stopped", "reason": "no command for 0.3 s"}, {}),
    "e-stop": ({"mode": "estop", "reason": "emergency stop by the console, page 1"}, {}),
    "taken": ({}, {"stop_reason": "another operator holds control", "mode": "hold"}),
    "link lost": ({}, {}),
}
HOLDS = ("run", "slowed", "held")


class Ur5(Operator):
    """An operator's program with a UR5 beside a ball."""

    def __init__(self):
        super().__init__()
        self.report = {}

    def receive(self):
        if self.silent:
            return []
        self.seq += 1
        posture = {
            "position": AT,
            "orientation": DOWN,
            "joints": HOME,
            "clearance": 0.051,
            "arm_clearance": 0.038,
        }
        seen = {"predicted": AHEAD, "predicted_orientation": DOWN, "target_count": 3}
        names = tuple(f"{name}_joint" for name in JOINTS)
        found = {
            report_key("r"): report(self.seq, **(seen | MARGIN | self.report)),
            mirror_key("r", "state"): state(self.seq, **(posture | self.state)),
            mirror_key("r", "scene"): scene(
                1,
                Obstacle("ball", (0.45, -0.18, 0.32), 0.07),
                targets=((0.45, 0.35, 0.3), (0.45, -0.05, 0.48), (0.45, -0.35, 0.3)),
            ),
            mirror_key("r", "description"): description(1, model="ur5", joint_names=names, radius=0.05),
            mirror_key("r", "command"): command(self.seq, plan=PLAN, plan_period_ns=100_000_000),
        }
        return [Packet(key, encode(message), self.clock.now_ns()) for key, message in found.items()]


@pytest.fixture(scope="module")
def desk():
    desk = Desk(Ur5(), _find_model)
    try:
        yield desk.sits_down()
    finally:
        desk.close()


def look(browser, width, height, theme):
    browser.cdp(
        "Emulation.setDeviceMetricsOverride",
        width=width,
        height=height,
        deviceScaleFactor=1,
        mobile=width < 700,
    )
    browser.cdp("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": theme}])
    if width < 700:
        browser.run("document.getElementById('with-sticks').click()")
    else:
        browser.run("document.getElementById('with-buttons').click()")


def theme_of(browser):
    return browser.run("return document.documentElement.dataset.theme")


CUT_OFF = """
const shown = [...document.querySelectorAll('header *, aside *, .pad *, .stick, .slide')].filter(e => e.offsetParent);
return shown.filter(e => { const r = e.getBoundingClientRect();
  return r.width > 1 && (r.left < 0 || r.top < 0 || r.right > innerWidth + 0.5 || r.bottom > innerHeight + 0.5); })
  .map(e => e.id || e.className || e.tagName);
"""


@pytest.mark.parametrize("name", STATES)
def test_each_state_is_said_and_nothing_is_cut_off(desk, name):
    browser, operator = desk.browser, desk.operator
    operator.state, operator.report = STATES[name]
    operator.silent = name == "link lost"
    try:
        if name in HOLDS:
            desk.presses()
        desk.until(lambda: browser.text("pill").lower() == name, f"the pill says {name}")
        for size, (width, height) in SIZES.items():
            for theme in ("dark", "light"):
                look(browser, width, height, theme)
                if PICTURES:
                    take(desk, name, f"{name.replace(' ', '-')}-{size}-{theme}.png")
                desk.until(lambda theme=theme: theme_of(browser) == theme, f"it is {theme}")
                assert browser.run(CUT_OFF) == [], (size, theme)
    finally:
        browser.key("KeyW", down=False)
        operator.silent = False
        operator.state, operator.report = {}, {}
        desk.until(lambda: browser.text("pill").lower() == "ready", "it is ready again")


def test_the_least_of_tool_and_arm_is_shown_and_named(desk):
    browser, operator = desk.browser, desk.operator
    desk.until(lambda: browser.text("clearance") == "38", "the arm's is shown")
    assert browser.text("clearance-of") == "mm arm · tool 51"
    assert browser.text("kept") == "tool margin 24"
    operator.report = {"limit": 0.01}
    try:
        desk.until(
            lambda: browser.text("kept") == "arm limit 10; tool 34 = limit + margin 24", "so are both limits"
        )
        assert browser.run(CUT_OFF) == []
        operator.state = {"arm_clearance": 0.2}
        desk.until(lambda: browser.text("clearance") == "51", "the tool's is shown")
        desk.until(
            lambda: browser.text("clearance-of") == "mm tool to ball · arm 200", "and what it is near to"
        )
    finally:
        operator.state, operator.report = {}, {}


def test_no_number_outlives_the_pill_that_says_the_link_is_lost(desk):
    browser, operator = desk.browser, desk.operator
    desk.until(lambda: browser.text("link") == "slow", "the link is measured")
    # All that stands on the page in one instant, the first in which the pill says so.
    browser.run(
        "window.first = null; new MutationObserver(() => { const pill = document.getElementById('pill').textContent;"
        " if (pill !== 'link lost' || window.first) return; setTimeout(() => window.first = ['link', 'asked',"
        " 'numbers', 'clearance-of'].map(id => document.getElementById(id).textContent), 0); })"
        ".observe(document.getElementById('pill'), {childList: true});"
    )
    operator.silent = True
    try:
        desk.until(lambda: browser.run("return window.first"), "the link is lost")
    finally:
        operator.silent = False
    link, *numbers = browser.run("return window.first")
    assert link == "lost"
    assert all(number.endswith("s ago") for number in numbers), numbers
    desk.until(lambda: browser.text("link") == "slow", "it is heard again")
    assert "ago" not in browser.text("numbers")


def take(desk, name, file):
    browser = desk.browser
    for how in ("2d", "3d"):  # anew: three dimensions that stay slow are drawn coarser
        browser.click(f"#draw input[value='{how}']")
    desk.pause.wait(0.7)
    for _ in range(10):  # three dimensions without a GPU leave little to the rest
        if name not in HOLDS or browser.text("pill").lower() == name:
            break
        browser.key("KeyW", down=False)
        desk.pause.wait(0.3)
        browser.key("KeyW")
        desk.pause.wait(0.5)
    browser.picture(Path(PICTURES) / file)
