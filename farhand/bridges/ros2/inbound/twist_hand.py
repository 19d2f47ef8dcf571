"""Hold-to-run for a stream of twists, which has no button: by arrival, and by a zero before each press.

| what comes | what is wanted |
|---|---|
| a twist that is not zero, in time, after a zero of the same sender | motion: a new press |
| more of them, in time, each 0.1 s after the one before at most | motion, the same press |
| a zero twist | nothing; what comes next is a new press |
| nothing for 0.1 s | nothing; a zero must come before anything moves again |
| a twist that was held up under way | nothing; the same |
| a twist that a newer one overtook | as if it had not come |
| a twist of another sender while one drives | nothing by that one |
| the first of a sender that is not zero | nothing: it was held before this program came |
"""

from dataclasses import dataclass

from farhand.bridges.ros2.inbound.arrivals import LATE, Arrivals
from farhand.common.geometry import norm
from farhand.common.messages.base import ZERO, Vector3
from farhand.common.messages.steering import Frame, Steering, Unit, unsent

SILENCE_NS = 100_000_000
"""Who says nothing for so long has let go."""
REST = 1e-6
"""A twist that is smaller in every part is zero (m/s and rad/s, or shares)."""
GIVES_UP_NS = 5_000_000_000
"""Who holds nothing for so long gives the wheel up."""
KNOWN = 16


@dataclass(frozen=True, slots=True)
class Wanted:
    """A twist that was read.

    Attributes:
        linear, angular: in `unit`.
        frame: whose axes.
    """

    linear: Vector3
    angular: Vector3
    frame: Frame = "base"

    @property
    def rests(self) -> bool:
        """Whether it wants nothing."""
        return norm(self.linear) < REST and norm(self.angular) < REST


class TwistHand:
    """Args:
    unit: what twists are in: `si` or `share`.

    Attributes:
        drives: whether it has moved something and not given the wheel up since.
        says: for people: what it waits for.
    """

    def __init__(self, unit: Unit = "si") -> None:
        self.drives, self.says = False, "waits for twists"
        self._unit: Unit = unit
        self._arrivals = Arrivals()
        self._rested: dict[bytes, bool] = {}
        self._driver: bytes | None = None
        self._wanted = Wanted(ZERO, ZERO)
        self._heard_ns = self._moved_ns = -(1 << 62)
        self._press = 0

    def hear(self, gid: bytes, seq: int, sent_ns: int, wanted: Wanted, now_ns: int) -> str:
        """Take a twist that arrived at `now_ns`; returns why it counts for nothing, or empty."""
        self._settle(now_ns)
        why = self._arrivals.judge(gid, seq, sent_ns, now_ns)
        if why:
            if why == LATE:
                self._unrest(gid)
            return why
        if wanted.rests:
            self._note(gid, True)
            if gid == self._driver:
                self.let_go()
                self._note(gid, True)
            return ""
        if self._driver is not None and gid != self._driver:
            self._note(gid, False)
            return "another sender drives"
        if gid != self._driver and not self._rested.get(gid, False):
            self._note(gid, False)
            self.says = "twists come that were not zero before: send one zero twist, then move"
            return "not zero before"
        if gid != self._driver:
            self._driver, self._press = gid, self._press + 1
            self._note(gid, False)
        self._wanted, self._heard_ns = wanted, now_ns
        self.says = "driven by twists"
        return ""

    def refuse(self, gid: bytes | None) -> None:
        """A message of that sender was none: what it holds is let go; None: whose it was is not known."""
        if gid is None or gid == self._driver:
            self.let_go()
        if gid is not None:
            self._note(gid, False)

    def let_go(self) -> None:
        """Nothing moves until there was a zero, and then a twist."""
        self._driver, self._wanted = None, Wanted(ZERO, ZERO)
        for gid in self._rested:
            self._rested[gid] = False
        self.says = "waits for twists: a zero first"

    def wish(self, now_ns: int) -> Steering:
        """What is wanted at `now_ns`; the instants never go back."""
        self._settle(now_ns)
        if self._driver is None:
            release = self.drives and now_ns - self._moved_ns > GIVES_UP_NS
            self.drives = self.drives and not release
            return unsent(press=self._press, release=release)
        self.drives, self._moved_ns = True, now_ns
        wanted = self._wanted
        return unsent(
            engaged=True,
            press=self._press,
            linear=wanted.linear,
            angular=wanted.angular,
            unit=self._unit,
            frame=wanted.frame,
        )

    def _settle(self, now_ns: int) -> None:
        if self._driver is not None and now_ns - self._heard_ns > SILENCE_NS:
            self.let_go()
            self.says = "the twists fell silent: a zero first, then move"

    def _unrest(self, gid: bytes) -> None:
        if gid == self._driver:
            self.let_go()
        self._note(gid, False)

    def _note(self, gid: bytes, rested: bool) -> None:
        self._rested.pop(gid, None)
        self._rested[gid] = rested
        while len(self._rested) > KNOWN:
            del self._rested[next(iter(self._rested))]
