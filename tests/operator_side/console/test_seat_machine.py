"""The seat as a state machine, before pages that lock nothing themselves, freeze, and whose lines hold messages up.

What is true (whose key is down, since when) is kept beside it; what the seat wants must follow from that.
"""

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from farhand.operator_side.console.said import Do, Steer
from farhand.operator_side.console.seat import GONE_AFTER_NS, Seat

MS = 1_000_000
TICK, IDLE = 20 * MS, 60 * MS
AGE = 350 * MS
"""How old what moves the robot may be: late by no more than LATE_NS, not noticed for no more than the silence."""
NUMBERS = st.integers(1, 3)


class Hand:
    """A page and the person before it, as they are."""

    def __init__(self, number, now_ns):
        self.number, self.down, self.press, self.frozen, self.stalled = number, False, 0, False, False
        self.n, self.offset_ms, self.spoke_ns, self.hurries = 0, 1000.0 * number, -IDLE, False
        self.pressed_ns, self.meant_ns = now_ns, -AGE
        self.line = []  # what is under way

    def speak(self, now_ns):
        if self.frozen or now_ns - self.spoke_ns < (TICK if self.down or self.hurries else IDLE):
            return
        self.n, self.spoke_ns, self.hurries = self.n + 1, now_ns, False
        if self.down:
            self.meant_ns = now_ns
        axes = (self.number / 3, 0.0, 0.0)
        self.line.append(Steer(self.n, now_ns / MS + self.offset_ms, self.down, self.press, linear=axes))

    def do(self, what, to=0):
        self.n += 1
        self.line.append(Do(self.n, what, to))


class SeatMachine(RuleBasedStateMachine):
    def __init__(self):
        super().__init__()
        self.seat, self.now = Seat(), 10_000 * MS
        self.hands, self.last = {}, 0
        self.disarmed_ns = -(10**12)
        self.ended, self.void = set(), set()
        self.moving = None
        for _ in range(2):
            self.join()

    def join(self):
        self.last += 1
        self.hands[self.last] = Hand(self.last, self.now)
        self.seat.join(self.last, f"page {self.last}", self.now)

    def hand(self, k):
        numbers = sorted(self.hands)
        return self.hands[numbers[k % len(numbers)]] if numbers else None

    def deliver(self, hand):
        while hand.line and not hand.stalled:
            said = hand.line.pop(0)
            before = self.seat.driver
            self.seat.hear(hand.number, said, self.now)
            if isinstance(said, Do) and said.what == "estop":
                self.disarmed_ns = self.now
            if self.seat.driver != before:
                assert before in (0, hand.number)  # nobody takes the wheel from who has it
                assert isinstance(said, Do)
                self.disarmed_ns = self.now
            self.look()

    def look(self):
        gone = self.hands.get(self.seat.driver)
        wish = self.seat.wish(self.now)
        if gone is not None and self.seat.driver != gone.number:
            assert self.now - self.seat.pages[gone.number].heard_ns > GONE_AFTER_NS
            self.disarmed_ns = self.now
        if not wish.engaged:
            self.ended |= {self.moving}
            self.moving = None
            return
        hand = self.hands[self.seat.driver]
        assert wish.linear == (hand.number / 3, 0.0, 0.0)
        assert not self.seat.locked
        assert not wish.estop
        assert self.now - hand.meant_ns <= AGE  # meant, not long ago
        assert hand.pressed_ns >= self.disarmed_ns - AGE  # pressed after whatever disarmed
        moving = (hand.number, self.seat.pages[hand.number].steer.press)
        assert moving not in self.ended  # what ended once moves nothing again
        assert moving not in self.void  # nor does what was pressed while its page slept
        self.moving = moving

    @rule(k=NUMBERS)
    def presses(self, k):
        hand = self.hand(k)
        if hand and not hand.down:
            hand.down, hand.press, hand.pressed_ns = True, hand.press + 1, self.now

    @rule(k=NUMBERS)
    def lets_go(self, k):
        if hand := self.hand(k):
            hand.down, hand.hurries = False, True

    @rule(k=NUMBERS, what=st.sampled_from(["take", "take", "release", "estop", "acknowledge"]))
    def does(self, k, what):
        hand = self.hand(k)
        if hand and not hand.frozen:
            hand.do(what)

    @rule(k=NUMBERS, to=NUMBERS)
    def gives(self, k, to):
        hand = self.hand(k)
        if hand and not hand.frozen:
            hand.do("give", self.hand(to).number)

    @rule(k=NUMBERS)
    def freezes_or_thaws(self, k):
        if hand := self.hand(k):
            hand.frozen = not hand.frozen

    @rule(k=NUMBERS)
    def line_is_held_up_or_goes_on(self, k):
        if hand := self.hand(k):
            hand.stalled = not hand.stalled

    @rule(k=NUMBERS)
    def newest_comes_twice(self, k):
        hand = self.hand(k)
        steer = hand and self.seat.pages[hand.number].steer
        if steer:
            self.seat.hear(hand.number, steer, self.now)

    @rule(why=st.sampled_from(["", "", "no news"]))
    def lock(self, why):
        self.seat.lock(why)
        if why:
            self.disarmed_ns = self.now

    @rule()
    def a_lock_that_is_short(self):
        self.lock("no news")
        self.look()
        self.lock("")

    @rule(k=NUMBERS)
    def drives(self, k):
        self.does(k, "take")
        self.lets_go(k)
        self.time_passes(20)
        self.presses(k)
        self.time_passes(2)

    @rule(k=NUMBERS, ticks=st.integers(20, 40))
    def what_was_pressed_while_the_line_was_held_up_comes_at_once(self, k, ticks):
        self.drives(k)
        hand = self.hand(k)
        hand.stalled = True
        self.lets_go(k)
        self.time_passes(1)
        self.presses(k)
        self.time_passes(2)
        self.lets_go(k)
        self.time_passes(ticks)
        hand.stalled = False
        self.time_passes(1)

    @rule(k=NUMBERS, ticks=st.integers(20, 40), first_ticks=st.sampled_from([0, 80]))
    def a_page_comes_whose_line_is_held_up(self, k, ticks, first_ticks):
        self.leaves_and_another_comes(k)
        hand = self.hands[self.last]
        hand.do("take")
        hand.stalled = True
        self.time_passes(1)
        if first_ticks:  # what is there comes late, and sets what counts as usual
            self.time_passes(first_ticks)
            hand.line, later = hand.line[:2], hand.line[2:]
            hand.stalled = False
            self.deliver(hand)
            hand.line, hand.stalled = later, True
            self.time_passes(16)
        hand.down, hand.press, hand.pressed_ns = True, 1, self.now
        self.time_passes(3)
        hand.down, hand.hurries = False, True
        self.time_passes(ticks)
        hand.stalled = False
        self.time_passes(1)

    @rule(k=NUMBERS, ticks=st.integers(13, 140))
    def sleeps_and_a_key_goes_down_meanwhile(self, k, ticks):
        self.drives(k)
        hand = self.hand(k)
        self.lets_go(k)
        self.time_passes(1)
        hand.frozen = True
        self.time_passes(ticks)
        self.presses(k)
        self.void.add((hand.number, hand.press))
        hand.frozen = False
        self.time_passes(30)

    @rule(k=NUMBERS)
    def stops_and_acknowledges_at_once(self, k):
        self.drives(k)
        self.does(k, "estop")
        self.does(k, "acknowledge")
        self.deliver(self.hand(k))

    @rule(k=NUMBERS, to=NUMBERS)
    def gives_and_gets_it_back_at_once(self, k, to):
        self.drives(k)
        for one, other in ((k, to), (to, k)):
            self.gives(one, other)
            self.deliver(self.hand(one))

    @rule(k=NUMBERS)
    def leaves_and_another_comes(self, k):
        if hand := self.hand(k):
            if self.seat.driver == hand.number:
                self.disarmed_ns = self.now
            del self.hands[hand.number]
            self.seat.leave(hand.number)
            self.join()

    @rule(ticks=st.one_of(st.integers(1, 12), st.sampled_from([25, 60, 170])))
    def time_passes(self, ticks):
        for _ in range(ticks):
            self.now += TICK
            for hand in self.hands.values():
                hand.speak(self.now)
                self.deliver(hand)
            self.look()

    @invariant()
    def one_driver_who_is_there(self):
        assert self.seat.driver in (0, *self.hands)
        self.look()


TestSeatMachine = SeatMachine.TestCase
TestSeatMachine.settings = settings(max_examples=100, stateful_step_count=30, deadline=None)


def test_the_machine_can_drive_at_all():
    machine = SeatMachine()
    machine.does(1, "take")
    machine.time_passes(25)
    machine.presses(1)
    machine.time_passes(2)
    assert machine.moving == (2, 1)


def test_a_line_that_is_held_up_twice_does_not_make_its_own_lateness_usual():
    """The first burst of a page tells nothing of how late it is: what the second brings must not count by it."""
    machine = SeatMachine()
    machine.drives(1)
    machine.a_page_comes_whose_line_is_held_up(k=1, ticks=35, first_ticks=0)
    machine.line_is_held_up_or_goes_on(1)
    machine.what_was_pressed_while_the_line_was_held_up_comes_at_once(k=1, ticks=20)
    assert machine.moving is None
