"""The whole way of a gamepad, from SDL to what the operator's program wants, in virtual time."""

import pytest

pytest.importorskip("pygame")

from farhand.common.link.link import Packet
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.keys import report_key, steering_key
from farhand.common.messages.steering import Steering
from farhand.operator_side.devices.device_node import DeviceNode
from farhand.operator_side.devices.hand import Hand
from farhand.operator_side.devices.sdl import SdlSource
from farhand.operator_side.steering.hand.gamepad import Gamepad, GamepadSettings
from farhand.operator_side.steering.hand.sender import SteeringSender
from farhand.testing import report, state, view
from tests.operator_side.devices.virtual_joystick import VirtualJoystick

MS = 1_000_000
HOLD_WITHIN_MS = 250
STRAIGHT = GamepadSettings(expo=0.0, scales=(1.0,))


@pytest.fixture(scope="module")
def source():
    source = SdlSource()
    yield source
    source.close()


@pytest.fixture
def stick(source):
    stick = VirtualJoystick()
    yield stick
    stick.unplug()
    source.read(0)


class Desk:
    """Device, its program and the operator's, on one clock; what travels arrives at once."""

    def __init__(self, source, settings=STRAIGHT):
        self.source, self.now, self.told, self.waiting = source, 0, [], []
        self.device = Gamepad(settings)
        self.device.listen(self)
        self.node = DeviceNode(
            Hand(settings, "gamepad"), self, SteeringSender("r", self, 1, "device", "gamepad")
        )
        self.reads, self.reports, self.seq = True, True, 0
        self.robot, self.report = {}, {}
        self._inbox = []

    def send(self, packet):
        """By the device's program."""
        assert packet.key == steering_key("r")
        self.told.append(Decoder(Steering).decode_or_raise(packet.payload))
        self.waiting.append(Packet(packet.key, packet.payload, self.now))

    def receive(self):
        """By both: the device's program hears reports, the operator's hears steering."""
        waiting, self._inbox = self._inbox, []
        return waiting

    def after(self, ms):
        """Let time pass in steps of 10 ms; what the operator's program wants at the end."""
        for _ in range(ms // 10):
            self.now += 10 * MS
            if self.reads:
                self.node.reading = self.source.read(self.now)
            if self.reports and self.now % (100 * MS) == 0:
                self.seq += 1
                payload = encode(report(**{"seq": self.seq, "safety": "run"} | self.report))
                self._inbox = [Packet(report_key("r"), payload, self.now)]
            self.node.step(self.now)
            self._inbox, self.waiting = self.waiting, []
            self.wants = self.device.read(view(self.now, state(**self.robot)))
            self._inbox = []
        return self.wants

    def moves(self, ms=50):
        wants = self.after(ms)
        return wants.engaged and any((*wants.velocity, *wants.angular))


@pytest.fixture
def desk(source, stick):
    desk = Desk(source)
    desk.after(200)
    return desk


def test_six_axes_in_metres_and_radians_a_second(desk, stick):
    stick.press("rightshoulder")
    desk.after(20)
    stick.move(lefty=-1.0, leftx=0.56, righttrigger=1.0, rightx=-1.0, righty=0.0)
    stick.press("dpleft")
    wants = desk.after(20)
    size = (1.0 + 0.5**2 + 1.0) ** 0.5
    assert wants.velocity == pytest.approx((0.25 / size, -0.125 / size, 0.25 / size), abs=1e-3)
    assert wants.angular == pytest.approx((-0.6 / 2**0.5, 0.0, 0.6 / 2**0.5), abs=1e-3)


def test_motion_only_while_the_deadman_is_held_and_by_a_fresh_press(desk, stick):
    stick.move(lefty=-1.0)
    assert not desk.moves()
    stick.move(lefty=0.0)
    desk.after(20)
    stick.press("rightshoulder")
    desk.after(20)
    stick.move(lefty=-1.0)
    assert desk.moves(20)
    stick.release("rightshoulder")
    assert not desk.moves(20)
    assert desk.told[-1].press == 1
    stick.press("rightshoulder")
    assert not desk.moves()  # the stick was off its centre when it was pressed
    assert "lefty" in desk.node.says


def test_an_unplugged_gamepad_holds_and_plugged_in_again_moves_nothing_before_a_fresh_press(desk, stick):
    stick.press("rightshoulder")
    desk.after(20)
    stick.move(lefty=-1.0)
    assert desk.moves(20)
    stick.unplug()
    assert not desk.moves(HOLD_WITHIN_MS)
    assert "unplugged" in desk.node.says
    stick.plug()
    stick.press("rightshoulder")
    stick.move(lefty=-1.0)
    assert not desk.moves(500)
    assert "let go of rightshoulder" in desk.node.says
    stick.release("rightshoulder")
    stick.move(lefty=0.0)
    desk.after(50)
    stick.press("rightshoulder")
    desk.after(50)
    stick.move(lefty=-1.0)
    assert desk.moves()


def test_another_gamepad_takes_the_place_of_one_that_is_unplugged_by_a_fresh_press(desk, stick):
    other = VirtualJoystick()
    try:
        desk.after(50)
        other.press("rightshoulder")
        assert not desk.after(50).engaged  # the first one is read
        stick.press("rightshoulder")
        assert desk.after(50).engaged
        stick.unplug()
        assert not desk.after(200).engaged
        other.release("rightshoulder")
        desk.after(20)
        other.press("rightshoulder")
        assert desk.after(20).engaged
    finally:
        other.unplug()


def test_it_shakes_without_a_word_where_it_cannot(source, stick):
    source.read(0)
    source.rumble(0.5)
    source.rumble(0.0)
    stick.unplug()
    source.rumble(0.5)


def test_a_stick_that_drifts_moves_nothing_by_itself(desk, stick):
    stick.move(leftx=0.4)
    assert not desk.moves(HOLD_WITHIN_MS)
    stick.press("rightshoulder")
    assert not desk.moves(HOLD_WITHIN_MS)
    stick.move(lefty=-1.0)
    assert desk.after(50).velocity == pytest.approx((0.25, 0.0, 0.0), abs=1e-3)
    stick.move(leftx=0.05)
    desk.after(50)
    stick.move(leftx=1.0)
    assert desk.after(50).velocity[1] < -0.1


def test_a_hand_that_the_operators_program_does_not_take_is_told_and_must_press_anew(desk, stick):
    stick.press("rightshoulder")
    desk.report = {"stop_reason": "device not engaged"}
    assert desk.after(400).engaged
    desk.after(400)
    assert not desk.told[-1].engaged
    assert "does not take this hand" in desk.node.says
    stick.release("rightshoulder")
    desk.after(20)
    assert "hold rightshoulder" in desk.node.says
    stick.press("rightshoulder")
    assert desk.after(20).engaged


def test_a_frozen_reading_lets_go(desk, stick):
    stick.press("rightshoulder")
    desk.after(20)
    stick.move(lefty=-1.0)
    assert desk.moves(20)
    desk.reads = False
    assert not desk.moves(HOLD_WITHIN_MS)
    desk.reads = True
    assert not desk.moves(HOLD_WITHIN_MS)


def test_a_frozen_program_lets_go(desk, stick):
    stick.press("rightshoulder")
    desk.after(20)
    stick.move(lefty=-1.0)
    assert desk.moves(20)
    wants = desk.device.read(view(desk.now + HOLD_WITHIN_MS * MS, state()))
    assert not wants.engaged


@pytest.mark.parametrize("gone", ["operator", "robot"])
def test_an_outage_lets_go_and_what_is_held_all_along_moves_nothing_afterwards(desk, stick, gone):
    stick.press("rightshoulder")
    desk.after(20)
    stick.move(lefty=-1.0)
    assert desk.moves(100)
    desk.reports, desk.report = gone != "operator", {"state_age": 2.0}
    assert not desk.moves(1500)
    assert "press anew" in desk.node.says
    stick.press("start")
    desk.after(50)
    assert not any(each.acknowledge for each in desk.told)
    desk.reports, desk.report = True, {}
    assert not desk.moves(500)


def test_stop_acknowledge_and_drive_on(desk, stick):
    stick.press("rightshoulder", "b")
    assert desk.after(20).estop
    stick.release("b")
    stopped = {"mode": "estop", "reason": "emergency stop by the operator"}
    desk.robot, desk.report = stopped, {"safety": "estop", "safety_reason": "emergency stop by the operator"}
    desk.after(500)
    assert "press start" in desk.node.says
    stick.press("start")
    wants = desk.after(20)
    assert (wants.acknowledge, wants.estop) == (True, False)
    desk.robot, desk.report = {}, {}
    stick.move(lefty=-1.0)
    assert not desk.moves(300)  # the deadman was held all along
    stick.move(lefty=0.0)
    stick.release("rightshoulder")
    desk.after(50)
    stick.press("rightshoulder")
    desk.after(50)
    stick.move(lefty=-1.0)
    assert desk.moves()


def test_it_gives_the_wheel_up(desk, stick):
    stick.press("rightshoulder")
    desk.after(20)
    assert desk.device.wheel.driver == 1
    stick.release("rightshoulder")
    desk.after(4000)
    assert desk.device.wheel.driver == 1
    desk.after(2000)
    assert desk.device.wheel.driver == 0


def test_speed_and_frame(source, stick):
    desk = Desk(source, GamepadSettings(expo=0.0))
    desk.after(200)
    for name, scale in (("dpup", 0.75), ("dpup", 1.0), ("dpup", 1.0), ("dpdown", 0.75)):
        stick.press(name)
        desk.after(20)
        stick.release(name)
        stick.press("rightshoulder")
        desk.after(20)
        stick.release("rightshoulder")
        desk.after(20)
        assert [each.scale for each in desk.told if each.engaged][-1] == scale
    stick.press("rightshoulder")
    desk.after(20)
    stick.press("back")
    assert not desk.after(20).engaged
    stick.release("rightshoulder")
    desk.after(20)
    stick.press("rightshoulder")
    desk.after(20)
    assert desk.told[-1].frame == "tool"


def test_a_joystick_without_a_mapping_has_raw_names_and_what_is_missing_is_said(source):
    stick = VirtualJoystick(kind=0)
    try:
        desk = Desk(source)
        desk.after(200)
        assert "it has no lefty" in desk.node.says
        assert desk.node.reading.inputs["axis0"] == 0.0
        raw = GamepadSettings(
            **dict.fromkeys(("y", "z", "roll", "pitch", "yaw"), ""), x="-axis1", deadman="button0"
        )
        raw = Desk(source, raw)
        raw.after(200)
        stick.press("a")
        raw.after(20)
        stick.move(lefty=-1.0)
        assert raw.moves(20)
    finally:
        stick.unplug()


def test_what_is_asked_and_not_done_is_felt_while_it_is_asked(desk, stick):
    stick.press("rightshoulder")
    desk.report = {"desired": (0.2, 0.0, 0.0), "filtered": (0.05, 0.0, 0.0)}
    desk.after(200)
    assert desk.node.strength == pytest.approx(0.75)
    stick.release("rightshoulder")
    desk.after(20)
    assert desk.node.strength == 0.0
