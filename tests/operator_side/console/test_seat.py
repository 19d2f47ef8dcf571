"""Who drives: hold-to-run, one driver, and all that moves nothing, however a page misbehaves."""

from farhand.operator_side.console.said import CutNetwork, Do, Steer
from farhand.operator_side.console.seat import BURST, GONE_AFTER_NS, SEEN_NS, SLEPT_NS, WAKES_NS, Seat

MS = 1_000_000


class Pages:
    """A seat, the time, and pages that say things in order."""

    def __init__(self, *numbers):
        self.seat, self.now, self.n = Seat(), 0, 0
        for number in numbers:
            self.seat.join(number, f"page {number}", 0)

    def does(self, number, what, to=0):
        self.n += 1
        return self.seat.hear(number, Do(self.n, what, to), self.now)

    def steers(self, number, engaged, press, late=0, n=None, seen=None):
        self.n += 1
        n = self.n if n is None else n
        said = Steer(n, self.now / MS - late, engaged, press, linear=(1.0, 0.0, 0.0), seen=seen)
        return self.seat.hear(number, said, self.now)

    def settle(self):
        """All of them say something in time, again and again, so that what they say counts."""
        for _ in range(WAKES_NS // (SLEPT_NS // 2)):
            for number in self.seat.pages:
                self.steers(number, False, 0)
            self.now += SLEPT_NS // 2

    def after(self, ms):
        self.now += ms * MS
        return self.seat.wish(self.now)


def driving():
    pages = Pages(1, 2)
    pages.now = 10_000 * MS
    pages.does(1, "take")
    pages.seat.wish(pages.now)
    pages.settle()
    pages.steers(1, True, 1)
    assert pages.seat.wish(pages.now).engaged
    return pages


def test_who_only_watches_moves_nothing():
    pages = driving()
    pages.steers(1, False, 1)
    pages.steers(2, True, 1)
    assert not pages.after(1).engaged


def test_release_and_silence_let_go_and_the_same_press_moves_nothing_any_more():
    pages = driving()
    assert pages.after(150).engaged
    assert not pages.after(1).engaged
    pages.steers(1, True, 1)
    assert not pages.after(1).engaged
    pages.steers(1, True, 2)
    assert pages.after(1).engaged
    pages.steers(1, False, 2)
    assert not pages.after(1).engaged


def test_what_comes_late_or_twice_or_out_of_order_moves_nothing():
    pages = driving()
    pages.steers(1, False, 1)
    pages.steers(1, True, 2, late=200)
    assert not pages.after(1).engaged
    assert pages.seat.pages[1].late
    pages.steers(1, True, 3, n=2)
    assert not pages.after(1).engaged
    pages.steers(1, True, 4)
    assert pages.after(1).engaged


def test_a_driver_that_leaves_or_is_gone_frees_the_wheel_once():
    pages = driving()
    pages.seat.leave(1)
    assert pages.seat.driver == 0
    assert pages.after(1).release
    assert not pages.after(1).release
    pages.does(2, "take")
    assert pages.seat.driver == 2
    pages.after(GONE_AFTER_NS // MS + 1)
    assert pages.seat.driver == 0


def test_a_handover_disarms_and_a_key_that_is_held_meanwhile_counts_for_nothing():
    pages = driving()
    pages.does(2, "take")
    assert pages.seat.driver == 1
    assert pages.seat.pages[2].asks
    pages.steers(2, True, 1)
    pages.does(1, "give", to=2)
    assert pages.seat.driver == 2
    pages.steers(2, True, 1)
    assert not pages.after(1).engaged
    pages.steers(2, True, 2)
    assert pages.after(1).engaged


def test_who_asked_gets_the_wheel_that_is_given_up():
    pages = driving()
    pages.does(2, "take")
    pages.does(1, "release")
    assert pages.seat.driver == 2


def test_anybody_stops_and_the_driver_alone_acknowledges():
    pages = driving()
    pages.does(2, "estop")
    wish = pages.after(1)
    assert (wish.estop, wish.engaged) == (True, False)
    pages.does(2, "acknowledge")
    assert not pages.after(1).acknowledge
    pages.steers(1, True, 2)
    assert not pages.after(1).engaged
    pages.after(1_000)
    pages.does(1, "acknowledge")
    wish = pages.after(1)
    assert (wish.estop, wish.acknowledge) == (False, True)
    assert not pages.after(1).acknowledge
    pages.steers(1, True, 2)
    assert not pages.after(1).engaged


def test_a_lock_lets_go_and_what_was_pressed_meanwhile_is_not_done_later():
    pages = driving()
    pages.seat.lock("no news")
    pages.steers(1, True, 2)
    assert not pages.after(1).engaged
    pages.seat.lock("")
    pages.steers(1, True, 2)
    assert not pages.after(1).engaged
    pages.steers(1, True, 3)
    assert pages.after(1).engaged


def test_who_says_too_much_must_go():
    pages = driving()
    said = [pages.steers(2, False, 0) for _ in range(round(BURST) + 1)]
    assert not said[-1]
    assert said[10]


def test_a_stop_counts_as_asked_for_until_the_robot_shows_it_or_it_is_acknowledged():
    for ends in (
        lambda pages: pages.seat.robot_shows(estop=True),
        lambda pages: pages.does(1, "acknowledge"),
    ):
        pages = driving()
        assert not pages.seat.stopping
        pages.does(2, "estop")
        pages.after(2_000)
        assert pages.seat.stopping
        ends(pages)
        assert not pages.seat.stopping


def test_the_driver_acknowledges_no_stop_that_another_page_has_just_asked_for():
    pages = driving()
    pages.does(2, "estop")
    pages.does(1, "acknowledge")
    wish = pages.after(20)
    assert (wish.estop, wish.acknowledge) == (True, False)
    assert pages.seat.stopping


def test_who_has_seen_no_frame_for_half_a_second_steers_blindly_and_moves_nothing():
    pages = driving()
    pages.steers(1, False, 1)
    fresh = (pages.now - SEEN_NS) // MS
    pages.steers(1, True, 2, seen=fresh - 1)
    assert not pages.after(0).engaged
    pages.steers(1, True, 3, seen=fresh)
    assert pages.after(0).engaged


def test_the_driver_alone_changes_the_network():
    pages = driving()
    pages.seat.hear(2, CutNetwork(100, 2.0), pages.now)
    assert pages.seat.change is None
    pages.seat.hear(1, CutNetwork(100, 2.0), pages.now)
    assert pages.seat.change == CutNetwork(100, 2.0)


def test_a_page_that_is_late_once_stays_and_one_whose_clock_was_asleep_is_to_begin_anew():
    pages = driving()
    pages.steers(1, False, 1, late=400)
    assert not pages.seat.strays(1, pages.now)
    for _ in range(60):
        pages.after(20)
        pages.steers(1, False, 1, late=400)
    assert pages.seat.strays(1, pages.now)
    pages.steers(1, False, 1)
    assert not pages.seat.strays(1, pages.now)
