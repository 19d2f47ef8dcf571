"""A SpaceMouse by HID: its reports, its deadman, its plug."""

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from farhand.operator_side.devices.cap_report import at_rest, take_report
from farhand.operator_side.devices.hand import Hand, Obstacles
from farhand.operator_side.devices.hid import SpacemouseSource
from farhand.operator_side.steering.hand.spacemouse import SpacemouseSettings

S = 1_000_000_000
FREE = Obstacles()


class FakeHid:
    """hidapi with one SpaceMouse, plugged in or not."""

    def __init__(self, **more):
        self.there, self.reports, self.may = True, [], True
        self.about = {
            "vendor_id": 0x256F, "product_id": 0xC635, "product_string": "SpaceMouse Compact", "path": b"/dev/hidraw0"
        } | more  # fmt: skip

    def enumerate(self):
        return [{**self.about, "vendor_id": 1, "path": b"mouse"}, *([self.about] if self.there else [])]

    def device(self):
        return self

    def open_path(self, path):
        assert path == b"/dev/hidraw0"
        if not self.may:
            raise OSError("open failed")

    def set_nonblocking(self, _on):
        pass

    def read(self, _size):
        if not self.there:
            raise OSError("read error")
        return list(self.reports.pop(0)) if self.reports else []

    def close(self):
        pass

    def pushes(self, *axes):
        self.reports.append(b"\x01" + struct.pack("<3h", *axes[:3]))
        self.reports.append(b"\x02" + struct.pack("<3h", *axes[3:]))

    def presses(self, bits):
        self.reports.append(bytes((3, bits, 0)))


def test_both_layouts_say_the_same_along_the_axes_of_who_sits_behind_the_robot():
    axes = (35, -70, 105, -140, 175, 350)
    one, two = at_rest(), at_rest()
    take_report(b"\x01" + struct.pack("<6h", *axes), one)
    take_report(b"\x01" + struct.pack("<3h", *axes[:3]), two)
    take_report(b"\x02" + struct.pack("<3h", *axes[3:]), two)
    assert one == two
    expected = {"capx": 0.2, "capy": -0.1, "capz": -0.3, "caproll": -0.5, "cappitch": 0.4, "capyaw": -1.0}
    assert {name: one[name] for name in expected} == pytest.approx(expected)


@given(st.binary(max_size=64))
def test_no_report_breaks_it(report):
    inputs = at_rest()
    take_report(report, inputs)
    assert all(-1.0 <= value <= 1.0 for value in inputs.values())


def test_button_cap_and_unplugging():
    hid = FakeHid()
    source, hand = SpacemouseSource(hid=hid), Hand(SpacemouseSettings(expo=0.0), "spacemouse")
    now = S
    assert not hand.feel(source.read(now), now, FREE).engaged
    hid.presses(1)
    assert hand.feel(source.read(now), now, FREE).engaged
    hid.pushes(0, -350, 0, 0, 0, -175)
    wish = hand.feel(source.read(now), now, FREE)
    assert wish.linear == (1.0, 0.0, 0.0)
    assert wish.angular == pytest.approx((0.0, 0.0, (0.5 - 0.12) / 0.88))
    hid.there = False
    assert not hand.feel(source.read(now), now, FREE).engaged
    hid.there = True
    hid.presses(1)
    now += S
    assert not hand.feel(source.read(now), now, FREE).engaged  # held while it is plugged in
    hid.presses(0)
    hand.feel(source.read(now), now, FREE)
    hid.presses(1)
    assert hand.feel(source.read(now), now, FREE).engaged


def test_the_cap_as_deadman_must_have_rested():
    hid = FakeHid()
    settings = SpacemouseSettings(expo=0.0, deadman="cap", dead_zone=0.0)
    source, hand = SpacemouseSource(hid=hid), Hand(settings, "spacemouse")
    hid.pushes(0, -350, 0, 0, 0, 0)
    assert not hand.feel(source.read(S), S, FREE).engaged
    hid.pushes(0, 0, 0, 0, 0, 0)
    assert not hand.feel(source.read(S), S, FREE).engaged
    hid.pushes(0, -350, 0, 0, 0, 0)
    assert hand.feel(source.read(S), S, FREE).linear == (1.0, 0.0, 0.0)


def test_one_that_may_not_be_opened_is_said():
    hid = FakeHid()
    hid.may = False
    source = SpacemouseSource(hid=hid)
    assert source.read(S) is None
    assert "SpaceMouse Compact is plugged in, and may not be opened" in source.trouble
    hid.may = True
    assert source.read(S + S // 10) is None  # it looks twice a second
    assert source.read(2 * S) is not None
    assert source.trouble == ""


def test_of_logitechs_devices_only_those_are_taken():
    assert SpacemouseSource(hid=FakeHid(vendor_id=0x46D, product_id=0xC534)).read(S) is None
    assert SpacemouseSource(hid=FakeHid(vendor_id=0x46D, product_id=0xC626)).read(S) is not None
    assert SpacemouseSource("pro", hid=FakeHid()).read(S) is None
