import pytest

from farhand.common.link.delivery import CLASSES, class_of
from farhand.common.link.zenoh_link import _HOW


@pytest.mark.parametrize(
    ("key", "name"),
    [
        ("farhand/r/command", "command"),
        ("farhand/r/state", "state"),
        ("farhand/r/camera/left", "camera"),
        ("farhand/r/invented", "other"),
        ("strange", "other"),
    ],
)
def test_the_class_is_the_kind_in_the_key(key, name):
    assert class_of(key) == name


def test_what_moves_and_stops_the_robot_is_never_dropped_nor_overtaken():
    order = {name: how[0].value for name, how in _HOW.items()} if hasattr(_HOW["state"][0], "value") else {}
    for name in ("command", "state"):
        assert CLASSES[name].keep == "every"
        assert CLASSES[name].blocks
        assert CLASSES[name].priority == "REAL_TIME"
    assert not CLASSES["camera"].blocks
    assert order.get("camera", 7) >= max(order.values(), default=7)
