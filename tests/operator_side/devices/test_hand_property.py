"""Hold-to-run at a device, whatever happens to it: nothing moves but by one press that is held all along."""

from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.operator_side.devices.hand import FROZEN_NS, Hand, Obstacles
from farhand.operator_side.devices.reading import Reading
from farhand.operator_side.steering.hand.gamepad import GamepadSettings

MS = 1_000_000
STICKS = ("lefty", "leftx", "rightx", "righty", "lefttrigger", "righttrigger")
BUTTONS = ("rightshoulder", "b", "start", "back", "dpup", "dpdown", "dpleft", "dpright")
FREE, LOST, STOPPED = Obstacles(), Obstacles(lost="no news"), Obstacles(stopped="stopped")

deadman = st.sampled_from([("press", "rightshoulder"), ("release", "rightshoulder")])
plug = st.sampled_from([("unplug",), ("plug",), ("replug",), ("freeze",), ("thaw",)])
others = st.tuples(st.sampled_from(["press", "release"]), st.sampled_from(BUTTONS[1:]))
stop = st.sampled_from([("press", "b"), ("release", "b"), ("press", "start"), ("release", "start")])
news = st.tuples(st.just("obstacles"), st.sampled_from([FREE, FREE, LOST, STOPPED]))
waits = st.tuples(st.just("wait"), st.sampled_from([0, 200, 1000, 6000]))
moves = st.tuples(st.just("move"), st.sampled_from(STICKS), st.sampled_from([-1.0, 0.0, 0.1, 0.6, 1.0]))
acts = st.one_of(deadman, deadman, plug, stop, news, waits, moves, others)
scripts = st.lists(acts, min_size=5, max_size=60)


class Bench:
    """A hand, its device, and what comes between them."""

    def __init__(self):
        self.hand, self.now = Hand(GamepadSettings(), "gamepad"), 0
        self.inputs = dict.fromkeys((*STICKS, *BUTTONS), 0.0)
        self.plugged, self.there, self.frozen, self.read_ns = 1, True, False, 0
        self.obstacles = FREE

    def act(self, what, *more):
        if what == "press":
            self.inputs[more[0]] = 1.0
        elif what == "release":
            self.inputs[more[0]] = 0.0
        elif what == "move":
            self.inputs[more[0]] = more[1]
        elif what == "unplug":
            self.there = False
        elif what == "plug":
            self.plugged += not self.there
            self.there = True
        elif what == "replug":
            self.plugged, self.there = self.plugged + 1, True
        elif what in ("freeze", "thaw"):
            self.frozen = what == "freeze"
        elif what == "obstacles":
            self.obstacles = more[0]
        else:
            self.now += more[0] * MS
        self.now += 10 * MS

    def feels(self):
        if not self.frozen:
            self.read_ns, self.shown = self.now, (dict(self.inputs), self.plugged)
        inputs, plugged = self.shown
        reading = Reading("pad", plugged, inputs, self.read_ns) if self.there else None
        return reading, self.hand.feel(reading, self.now, self.obstacles)


@settings(max_examples=150)
@given(scripts)
def test_nothing_moves_but_by_a_fresh_press_that_is_held(script):
    bench = Bench()
    bench.feels()
    press, up = 0, True  # whether the deadman was seen up since the last time that anything let go
    for act in (("wait", 0), *script):
        bench.act(*act)
        reading, wish = bench.feels()
        shows = reading is not None and bench.now - reading.read_ns <= FROZEN_NS
        down = shows and reading.inputs["rightshoulder"] > 0.5
        if wish.engaged:
            assert down
            assert bench.obstacles == FREE
            assert reading.inputs["b"] == 0.0
            assert not wish.estop
            assert wish.press > press or not up  # goes on with its press, or is a new one after a release
            press = wish.press
        else:
            assert (wish.linear, wish.angular) == ((0.0,) * 3, (0.0,) * 3)
        if shows and reading.inputs["b"]:
            assert wish.estop
        assert not wish.acknowledge or bench.obstacles != LOST
        assert wish.press >= press
        up = shows and not down
        assert all(-1.0 <= value <= 1.0 for value in (*wish.linear, *wish.angular))


@settings(max_examples=150)
@given(scripts)
def test_what_let_go_once_stays_let_go_until_the_deadman_is_released(script):
    bench = Bench()
    bench.feels()
    spent, plugged = False, 1
    for act in script:
        bench.act(*act)
        reading, wish = bench.feels()
        if reading is not None and reading.plugged != plugged:
            spent, plugged = True, reading.plugged
        shows = reading is not None and bench.now - reading.read_ns <= FROZEN_NS
        if shows and not reading.inputs["rightshoulder"]:
            spent = False
        elif not shows or bench.obstacles != FREE or reading.inputs["b"]:
            spent = True
        assert not (spent and wish.engaged)


@given(st.sampled_from(STICKS), st.sampled_from([-1.0, 0.3, 1.0]))
def test_an_input_that_is_off_its_centre_moves_nothing_until_it_has_been_back(name, value):
    bench = Bench()
    bench.feels()
    bench.act("move", name, value)
    bench.act("press", "rightshoulder")
    _, wish = bench.feels()
    assert wish.engaged
    assert not any((*wish.linear, *wish.angular))
    bench.act("move", name, 0.1)
    bench.feels()
    bench.act("move", name, value)
    _, wish = bench.feels()
    assert any((*wish.linear, *wish.angular))
