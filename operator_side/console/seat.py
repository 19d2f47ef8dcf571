"""Who of several pages drives, and what the operator's program is told of it: a state machine that is told the time.

One drives, the others watch. A page that closes, freezes or falls silent has let go (latch.py); whatever it says
late, twice or out of order moves nothing.
"""

from dataclasses import dataclass, field

import msgspec

from farhand.common.messages.steering import Steering, unsent
from farhand.operator_side.console.said import ChooseNetwork, CutNetwork, Do, Ordered, Steer
from farhand.operator_side.steering.hand.latch import Latch

GONE_AFTER_NS = 3_000_000_000
"""A driver that says nothing for so long drives no more."""
LATE_NS = 150_000_000
"""A message that took so much longer than the fastest of its page counts as not sent."""
SETTLED_NS = 50_000_000
"""A page whose messages become faster by more than this was late until now, and for LATE_NS nothing of it counts: so
what was held up since the page came moves nothing when it comes all at once."""
SLEPT_NS, WAKES_NS = 200_000_000, 300_000_000
"""A page speaks some sixteen times a second, and oftener while something is held. One that said nothing for the first
was asleep, or its line held up: for the second nothing of it counts. What comes then was pressed meanwhile, and how old
it is cannot be told by messages that were all held up; what comes without such a gap is no older than the gap."""
STRAYS_NS = 1_000_000_000
"""Who is late all the while for so long is not late by chance."""
SEEN_NS = 500_000_000
"""Whoever steers has seen a frame that is not older than this."""
ESTOP_FOR_NS = 1_000_000_000
"""For so long an emergency stop is said again and again; the operator's program goes on until the robot has it."""
RATE, BURST = 200.0, 400.0
"""Messages a second of one page, and at once."""


@dataclass(slots=True)
class Page:
    """A connected page.

    Attributes:
        name: for people.
        heard_ns: when it said anything.
        latch: of its hand.
        asks: whether it asks for the wheel that another one has.
        late: whether its newest message came too late to count, and `late_ns` since when all of them did.
        blind: whether it steers without having seen a new frame.
        order: number of the newest message.
        steer: the newest of its kind, which came at `steered_ns`.
        fastest_ns: least difference between this clock and the page's of all messages: the time under way, but for a
            constant. None: none has come.
        usual_ns: the same when it became less by much for the last time.
        settles_ns: until then nothing of it counts.
        allowance: how many messages it may still send at once.
    """

    name: str
    heard_ns: int
    latch: Latch = field(default_factory=Latch)
    asks: bool = False
    late: bool = False
    late_ns: int = 0
    blind: bool = False
    order: int = -1
    steer: Steer | None = None
    fastest_ns: int | None = None
    usual_ns: int = 0
    steered_ns: int = 0
    settles_ns: int = 0
    allowance: float = BURST


class Seat:
    """Attributes:
    pages: by number.
    driver: number of the page that drives; 0: none.
    locked: why nobody may drive now; empty: nothing is in the way.
    stopping: whether an emergency stop was asked for that the robot has not latched yet.
    latched: whether the robot shows an emergency stop.
    stopped_by: the page that asked for the one that is asked for or shown; empty: none did.
    change: of the network, that the driver asked for and nobody has taken up yet.
    """

    def __init__(self) -> None:
        self.pages: dict[int, Page] = {}
        self.driver = 0
        self.locked = ""
        self.stopping = self.latched = False
        self.stopped_by = ""
        self.change: ChooseNetwork | CutNetwork | None = None
        self._press = 0
        self._estop_ns: int | None = None
        self._estop_by = 0  # number of the page that asked for it last
        self._acknowledge = self._take = self._release = False

    def join(self, number: int, name: str, now_ns: int) -> None:
        """A page has come."""
        self.pages[number] = Page(name, now_ns)

    def leave(self, number: int) -> None:
        """A page is gone."""
        self.pages.pop(number, None)
        if self.driver == number:
            self._free()

    def hear(self, number: int, said: Ordered, now_ns: int) -> bool:
        """Take what a page says; False where it says too much and must go."""
        page = self.pages[number]
        page.allowance = min(BURST, page.allowance + (now_ns - page.heard_ns) * 1e-9 * RATE) - 1.0
        page.heard_ns = now_ns
        if page.allowance < 0.0:
            return False
        if said.n <= page.order:
            return True
        page.order = said.n
        if isinstance(said, Do):
            self._do(number, page, said, now_ns)
        elif not isinstance(said, Steer):
            self.change = said if number == self.driver else self.change
        else:
            self._steer(number, page, said, now_ns)
        return True

    def lock(self, why: str) -> None:
        """Let nobody drive while `why` is not empty; afterwards a new press is needed."""
        self.locked = why
        if why:
            for page in self.pages.values():
                page.latch.disarm()

    def robot_shows(self, *, estop: bool) -> None:
        """Whether the robot shows an emergency stop that it has latched."""
        self.latched = estop
        if estop:
            self.stopping = False
        elif not self.stopping:
            self.stopped_by = ""

    def holds(self, now_ns: int) -> bool:
        """Whether the driver holds something down."""
        page = self.pages.get(self.driver)
        return page is not None and not self.locked and page.latch.holds(now_ns)

    def counts(self, number: int, now_ns: int) -> bool:
        """Whether a press of this page would count now: it is heard, in time."""
        page = self.pages.get(number)
        if page is None or page.steer is None or page.late or page.blind:
            return False
        return now_ns >= page.settles_ns

    def strays(self, number: int, now_ns: int) -> bool:
        """Whether a page's clock is not what it was, as after a long sleep: it had better begin anew."""
        page = self.pages.get(number)
        return page is not None and page.late and now_ns - page.late_ns > STRAYS_NS

    def wish(self, now_ns: int) -> Steering:
        """What is wanted at `now_ns`; buttons that are pressed once are in one wish only."""
        page = self.pages.get(self.driver)
        if page is not None and now_ns - page.heard_ns > GONE_AFTER_NS:
            self._free()
            page = None
        if self._estop_ns is not None and now_ns - self._estop_ns > ESTOP_FOR_NS:
            self._estop_ns = None
        estop, holds = self._estop_ns is not None, self.holds(now_ns)
        wish = unsent(
            press=self._press,
            estop=estop,
            acknowledge=self._acknowledge and not estop,
            take=self._take,
            release=self._release,
        )
        self._acknowledge = self._take = self._release = False
        if page is None or page.steer is None or not holds or estop:
            return wish
        said = page.steer
        return msgspec.structs.replace(
            wish,
            engaged=True,
            linear=said.linear,
            angular=said.angular,
            frame=said.frame,
            view=said.view,
            scale=said.scale,
        )

    def _steer(self, number: int, page: Page, said: Steer, now_ns: int) -> None:
        late = _is_late(page, said, now_ns)
        page.late_ns = page.late_ns if late and page.late else now_ns
        page.late = late
        page.blind = said.seen is not None and now_ns - said.seen * 1_000_000 > SEEN_NS
        held = page.latch.holds(now_ns)
        page.steer = said
        counts = number == self.driver and self.counts(number, now_ns)
        may = counts and not self.locked and self._estop_ns is None
        page.latch.hear(said.engaged and may, said.press, now_ns)
        if page.latch.holds(now_ns) and not held:
            self._press += 1

    def _do(self, number: int, page: Page, said: Do, now_ns: int) -> None:
        if said.what == "estop":
            self._estop_ns, self._estop_by, self.stopping = now_ns, number, True
            if not self.latched:
                self.stopped_by = page.name
            for each in self.pages.values():
                each.latch.disarm()
        elif said.what == "take":
            page.asks = self.driver != number
            if self.driver == 0:
                self._give(number)
        elif number != self.driver:
            return
        elif said.what == "acknowledge":
            # another page's emergency stop that is still sent was not there to be acknowledged
            self._acknowledge = self._estop_ns is None or (number == self._estop_by and self.latched)
            self._estop_ns = None if self._acknowledge else self._estop_ns
            self.stopping = self.stopping and not self._acknowledge
        elif said.what == "release":
            self._free()
        elif said.to in self.pages:
            self._give(said.to)

    def _give(self, number: int) -> None:
        self.driver, self._take = number, True
        self.pages[number].asks = False
        for page in self.pages.values():
            page.latch.disarm()

    def _free(self) -> None:
        self.driver, self._release = 0, True
        waiting = next((number for number, page in self.pages.items() if page.asks), 0)
        if waiting:
            self._give(waiting)
            self._release = False


def _is_late(page: Page, said: Steer, now_ns: int) -> bool:
    """Whether a message was held up under way; notes how long this page's usually take, on no clock in common."""
    took_ns = now_ns - round(said.t * 1e6)
    if page.fastest_ns is None or took_ns < page.usual_ns - SETTLED_NS:
        page.usual_ns, page.settles_ns = took_ns, now_ns + LATE_NS
    if now_ns - page.steered_ns > SLEPT_NS:
        page.settles_ns = now_ns + WAKES_NS
    page.steered_ns = now_ns
    page.fastest_ns = took_ns if page.fastest_ns is None else min(page.fastest_ns, took_ns)
    return took_ns - page.fastest_ns > LATE_NS
