"""Pictures on their way to pages: how old they are, which one a page gets, what is said when there is none."""

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.common.link.link import Packet
from farhand.common.messages.base import Echo
from farhand.common.messages.camera import CameraFrame
from farhand.common.messages.codec import encode
from farhand.common.messages.keys import mirror_key, report_key
from farhand.operator_side.console.camera import CameraFeed
from farhand.operator_side.console.picture import Picture
from farhand.operator_side.console.stamps import Stamps
from farhand.testing import OPERATOR_SESSION, ROBOT_SESSION, command, report, state
from tests.operator_side.console.operator import frame

MS, SECOND = 1_000_000, 1_000_000_000


class World:
    """Three clocks, a network between two of them; `true_ns` is nobody's."""

    def __init__(self, robot_ahead=0, operator_ahead=0):
        self.robot_ahead, self.operator_ahead = robot_ahead, operator_ahead
        self.picture, self.seq = Picture("r"), 0

    def exchange(self, true_ns, up_ns, down_ns, hold_ns=0):
        """A command at `true_ns`, the state that answers it, the command and the report after that; the time."""
        self.seq += 2
        at_robot = true_ns + up_ns
        answered = at_robot + hold_ns
        back = answered + down_ns
        operator, robot = self.operator_ahead, self.robot_ahead
        first = Echo(OPERATOR_SESSION, self.seq, true_ns + operator, hold_ns)
        answer = state(self.seq, echo=first, t_sent_ns=answered + robot, t_sample_ns=answered + robot)
        after = back + hold_ns
        second = Echo(ROBOT_SESSION, self.seq, answered + robot, hold_ns)
        follows = command(self.seq + 1, echo=second, t_sent_ns=after + operator)
        told = report(self.seq + 1, t_sent_ns=after + operator)
        for key, message in (
            (mirror_key("r", "state"), answer),
            (mirror_key("r", "command"), follows),
            (report_key("r"), told),
        ):
            self.picture.take(Packet(key, encode(message), after))
        return after


delay = st.integers(0, 2 * SECOND)


@settings(max_examples=100, deadline=None)
@given(
    st.integers(1 << 42, 1 << 45),
    st.integers(1 << 42, 1 << 45),
    st.lists(st.tuples(delay, delay, st.integers(0, 50 * MS)), min_size=1, max_size=8),
    st.integers(0, SECOND),
)
def test_the_true_age_lies_between_the_bounds_whatever_clocks_and_network(robot, operator, trips, taken_ns):
    world, stamps, now = World(robot, operator), Stamps(), SECOND
    for up, down, hold in trips:
        now = world.exchange(now, up, down, hold)
        stamps.look(world.picture, now)
    captured = SECOND + taken_ns
    now = max(now, captured)
    least, most = stamps.ages(ROBOT_SESSION, captured + robot, now)
    true = (now - captured) * 1e-9
    assert least - 1e-6 <= true <= most + 1e-6
    assert most - least <= min(up + down for up, down, _ in trips) * 1e-9 + 1e-6


def test_bounds_follow_a_robot_that_starts_anew_and_are_none_without_its_session():
    world, stamps = World(5 * SECOND), Stamps()
    assert stamps.ages(ROBOT_SESSION, 0, 0) is None
    now = world.exchange(SECOND, 20 * MS, 20 * MS)
    stamps.look(world.picture, now)
    assert stamps.ages(ROBOT_SESSION, now + 5 * SECOND, now) == pytest.approx((0.0, 0.02))
    assert stamps.ages(0, now, now) is None
    assert stamps.ages(ROBOT_SESSION + 1, now, now) is None


def fed(*frames, now=SECOND):
    feed = CameraFeed("r")
    for each in frames:
        feed.take(Packet(mirror_key("r", "camera"), encode(each), now))
    return feed


def test_a_page_gets_the_newest_alone_and_the_next_one_when_it_has_that():
    feed, now = fed(frame(1), frame(3), frame(2)), SECOND
    told = feed.next(7, now)
    assert (told["jpeg"][-1], told["width"], told["height"], told["source"]) == (3, 320, 240, "pybullet")
    assert (told["said"], told["captured_age_ms"]) == ("", None)
    for seq in range(4, 9):
        now += 100 * MS
        feed.take(Packet(mirror_key("r", "camera"), encode(frame(seq)), now))
        assert feed.next(7, now) is None  # it is slow: nothing queues for it
    assert feed.next(8, now)["jpeg"][-1] == 8  # and another page does not wait for it
    assert feed.pictured(7)
    assert feed.next(7, now)["jpeg"][-1] == 8
    assert feed.next(7, now) is None


def test_a_page_gets_at_most_twenty_a_second():
    feed, shown = fed(), 0
    for n in range(300):  # 100 a second for three seconds
        now = SECOND + n * 10 * MS
        feed.take(Packet(mirror_key("r", "camera"), encode(frame(n)), now))
        told = feed.next(1, now)
        shown += bool(told and told["jpeg"])
        feed.pictured(1)
    assert 55 <= shown <= 61


def test_a_page_that_acknowledges_what_it_was_not_sent_is_let_go():
    feed = fed(frame(1))
    feed.next(1, SECOND)
    assert feed.pictured(1)
    assert all(feed.pictured(1) for _ in range(50))
    assert not feed.pictured(1)


def test_a_page_that_is_given_up_on_now_and_then_is_never_let_go():
    feed, now = fed(), SECOND
    for seq in range(120):  # each picture is acknowledged after the next one was sent in its place
        feed.take(Packet(mirror_key("r", "camera"), encode(frame(2 * seq)), now))
        assert feed.next(1, now)["jpeg"]
        now += 2 * SECOND
        feed.take(Packet(mirror_key("r", "camera"), encode(frame(2 * seq + 1)), now))
        assert feed.next(1, now)["jpeg"]
        assert feed.pictured(1)
        assert feed.pictured(1)
        now += 100 * MS


def test_no_camera_one_that_stops_and_one_that_shows_what_is_old_are_said():
    feed, now = fed(), SECOND
    assert feed.next(1, now)["said"] == "no camera: no picture has come"
    assert feed.next(1, now + 100 * MS) is None
    assert feed.next(1, now + 600 * MS)["said"].startswith("no camera")
    world = World()
    now = world.exchange(10 * SECOND, 5 * MS, 5 * MS)
    feed.look(world.picture, now)
    feed.take(Packet(mirror_key("r", "camera"), encode(frame(1, now - 30 * MS)), now))
    told = feed.next(1, now)
    assert told["said"] == ""
    assert told["jpeg"]
    assert told["captured_age_least_ms"] == pytest.approx(25.0)
    assert told["captured_age_ms"] == pytest.approx(35.0)
    feed.pictured(1)
    now += 2300 * MS
    feed.look(world.picture, now)
    told = feed.next(1, now)
    assert (told["said"], told["jpeg"]) == ("no picture for 2.3 s: nor does any state", b"")
    feed.take(Packet(mirror_key("r", "camera"), encode(frame(2, now - 3000 * MS)), now))
    told = feed.next(1, now)
    assert told["said"] == "the picture is at least 3.0 s old"
    assert told["jpeg"]


def test_what_is_no_picture_changes_nothing():
    feed = fed(frame(1))
    feed.take(Packet(mirror_key("r", "camera"), encode(frame(2))[:-1], SECOND))
    feed.take(Packet(mirror_key("r", "state"), encode(frame(3)), SECOND))
    assert feed.next(1, SECOND)["jpeg"][-1] == 1
    with pytest.raises(msgspec.ValidationError):
        msgspec.convert(msgspec.to_builtins(frame(1)) | {"width": 0}, CameraFrame)
