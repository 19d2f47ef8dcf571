"""From packets to changes of the scene: which are obeyed, and what is answered.

A request is obeyed once at the most. It names the revision of the scene that it was made for, and each change makes a
new one: what is replayed, overtaken or late finds another revision. And its echo must be of a recent state of this
start of the robot's program: what was held up on its way is refused as a command is, by the robot's own clock.
"""

from collections import Counter, OrderedDict, deque
from collections.abc import Callable, Sequence

import msgspec

from farhand.common.link.link import Packet
from farhand.common.messages.codec import Decoder
from farhand.common.messages.keys import scene_request_key
from farhand.common.messages.scene import MAX_ANSWERS, MAX_OBSTACLES, Obstacle, SceneAnswer
from farhand.common.messages.scene_request import (
    MOST_BYTES_ASKED,
    MOST_BYTES_LIVE,
    MOST_MOVERS,
    SceneRequest,
)
from farhand.common.timing.clock import to_ns
from farhand.robot_side.safety.settings import SafetySettings

WAITING = 16
"""Requests that wait to be judged, one a tick."""
REMEMBERED_SESSIONS = 64
AGAIN_NS = 100_000_000
"""Between two announcements."""
REPEATED_NS = 1_000_000_000
"""For so long a change is announced again and again: a network may lose some."""

HEAD_BYTES = 2_000
"""Of a request, beside its obstacles."""

Crowded = Callable[[Sequence[Obstacle]], str]
"""Why obstacles cannot be there: they would be on the robot; empty: they can."""


class _Head(msgspec.Struct, frozen=True):
    """Enough of a request to know a copy of one that is decided: cheaper than the whole, and decides nothing else."""

    session: int = 0
    seq: int = -1


class SceneIntake:
    """Judges requests to change the scene.

    Args:
        name: the robot's name, part of the key.
        settings: how old a state may be that a request is built on.
        session: the robot's own, which echoes must name.

    Attributes:
        revision: changes so far.
        refused: requests that changed nothing, by reason.
        newest_refusal: to whom and why, for people; empty: there was none.
        log: the newest changes, for people; whoever says them takes them out.
    """

    def __init__(self, name: str, settings: SafetySettings, session: int) -> None:
        self._key, self._session = scene_request_key(name), session
        self._max_age_ns = to_ns(settings.max_age)
        self._decoder = Decoder(SceneRequest)
        self._heads = msgspec.msgpack.Decoder(_Head)
        self._waiting: deque[bytes] = deque()
        self._answers: OrderedDict[int, SceneAnswer] = OrderedDict()
        self._newest_seq: dict[int, int] = {}
        self._counted: Counter[str] = Counter()
        self._unsaid = self._changed = False
        self._said_ns, self._repeat_until_ns = -AGAIN_NS, 0
        self.revision = 0
        self.newest_refusal = ""
        self.log: deque[str] = deque(maxlen=64)

    @property
    def refused(self) -> dict[str, int]:
        """Requests that changed nothing, by reason."""
        return dict(self._decoder.refused + self._counted)

    @property
    def answers(self) -> tuple[SceneAnswer, ...]:
        """To the newest requests, the newest last."""
        return tuple(self._answers.values())[-MAX_ANSWERS:]

    def take(self, packets: Sequence[Packet]) -> None:
        """Keep the requests among what has arrived, for `judge`."""
        for packet in packets:
            if packet.key != self._key:
                continue
            if len(self._waiting) >= WAITING:
                self._count("flood", "a request: more at once than are looked at")
                continue
            if len(packet.payload) > MOST_BYTES_ASKED + HEAD_BYTES:
                self._count("too-large", f"a request of more than {MOST_BYTES_ASKED} bytes")
                continue
            self._waiting.append(packet.payload)

    @property
    def waits(self) -> bool:
        """Whether there is a request to be judged."""
        return bool(self._waiting)

    def judge(
        self, obstacles: tuple[Obstacle, ...], now_ns: int, crowded: Crowded
    ) -> tuple[Obstacle, ...] | None:
        """The obstacles as the oldest request that waits has them; None where nothing changes.

        Args:
            obstacles: as they are now.
            now_ns: robot clock.
            crowded: says why obstacles cannot come to be where they are said to be.
        """
        request = self._next()
        if request is None:
            return None
        stale = self._staleness(request, now_ns)
        if stale:
            self._refuse(request, stale, _MEANINGS[stale], settled=False)
            return None
        if request.base != self.revision:
            why = f"the scene is at revision {self.revision}, this was asked of {request.base}: look, and ask again"
            self._refuse(request, "changed", why)
            return None
        found, why = _changed(request, obstacles)
        if not why:
            known_ones = set(obstacles) if request.deed == "set" else set()
            why = crowded([o for o in request.obstacles if o not in known_ones])
        if why:
            self._refuse(request, "unfit", why)
            return None
        self._obey(request, obstacles, found, now_ns)
        return found

    def due(self, now_ns: int) -> bool:
        """Whether the scene is to be announced now, by what was asked."""
        if not (self._unsaid or self._changed or now_ns < self._repeat_until_ns):
            return False
        return self._changed or now_ns - self._said_ns >= AGAIN_NS

    def said(self, now_ns: int) -> None:
        """The scene has been announced."""
        self._unsaid = self._changed = False
        self._said_ns = now_ns

    def _next(self) -> SceneRequest | None:
        """The oldest request that waits; None: it is refused in decoding, or a copy of a decided one, told again."""
        payload = self._waiting.popleft()
        try:
            session = self._heads.decode(payload).session
        except (msgspec.MsgspecError, ValueError, RecursionError, OverflowError):
            session = 0  # the whole says what is wrong with it
        known = self._answers.get(session)
        if known is not None and known.settled:
            self._answers.move_to_end(session)  # among the newest, which are said
            self._unsaid = True
            return None
        request = self._decoder.decode(payload)
        if request is None:
            reason = self._decoder.last_refusal.partition(":")[0]  # the rest may repeat a stranger's letters
            self.newest_refusal = f"what is no request ({reason})"
        return request

    def _staleness(self, request: SceneRequest, now_ns: int) -> str:
        """Why the request is not newer than all before it, or not built on a recent state; empty: it is."""
        echo = request.echo
        if request.seq <= self._newest_seq.get(request.session, -1):
            return "old-seq"
        if echo is None:
            return "no-echo"
        if echo.session != self._session:
            return "foreign-echo"
        return "" if 0 <= now_ns - echo.t_sent_ns <= self._max_age_ns else "stale"

    def _refuse(self, request: SceneRequest, reason: str, why: str, *, settled: bool = True) -> None:
        self._count(reason, f"to {request.source}: {why}")
        if reason != "old-seq":
            self._answer(request, SceneAnswer(request.session, why[:512], settled))

    def _count(self, reason: str, said: str) -> None:
        self._counted[reason] += 1
        self.newest_refusal = said

    def _obey(
        self,
        request: SceneRequest,
        before: tuple[Obstacle, ...],
        after: tuple[Obstacle, ...],
        now_ns: int,
    ) -> None:
        self.revision += 1
        self._changed, self._repeat_until_ns = True, now_ns + REPEATED_NS
        self._answer(request, SceneAnswer(request.session))
        old, new = set(before), set(after)
        came = [o.id for o in after if o not in old]
        went = [o.id for o in before if o not in new]
        said = [f"{what} {', '.join(names)}" for what, names in (("came", came), ("went", went)) if names]
        self.log.append(
            f"scene: revision {self.revision} by {request.source}: {'; '.join(said) or 'as it was'}; "
            f"{len(after)} obstacles"
        )

    def _answer(self, request: SceneRequest, answer: SceneAnswer) -> None:
        self._unsaid = True
        self._answers[request.session] = answer
        self._answers.move_to_end(request.session)
        self._newest_seq[request.session] = request.seq
        if len(self._answers) > REMEMBERED_SESSIONS:
            oldest, _ = self._answers.popitem(last=False)
            self._newest_seq.pop(oldest, None)


_MEANINGS = {
    "old-seq": "not newer than the last of its sender: replayed or overtaken",
    "no-echo": "built on no state of this robot",
    "foreign-echo": "built on a state of another start of this robot",
    "stale": "built on a state that is too old: late on its way",
}


def _changed(request: SceneRequest, now: tuple[Obstacle, ...]) -> tuple[tuple[Obstacle, ...], str]:
    """The obstacles with what is asked for, or why that makes no sense."""
    names = {o.id for o in now}
    twice = _first_twice([*(o.id for o in request.obstacles), *request.gone])
    if twice:
        return (), f"obstacle {twice!r} is named twice"
    if request.deed == "remove":
        unknown = [name for name in request.gone if name not in names]
        if unknown or not request.gone:
            there = ", ".join(sorted(names)[:20]) or "none"
            return (), f"there is no obstacle {unknown[0] if unknown else ''!r}; there are {there}"
        gone = set(request.gone)
        return tuple(o for o in now if o.id not in gone), ""
    if request.gone:
        return (), f"a request to {request.deed} takes no obstacle away"
    known = next((o.id for o in request.obstacles if o.id in names), "") if request.deed == "add" else ""
    if known:
        return (), f"obstacle {known!r} is there already; remove it first"
    after = request.obstacles if request.deed == "set" else (*now, *request.obstacles)
    if len(after) > MAX_OBSTACLES:
        return (), f"{len(after)} obstacles, at most {MAX_OBSTACLES} are possible"
    size = len(msgspec.msgpack.encode(after))
    if size > MOST_BYTES_LIVE:
        return (), (
            f"the obstacles would take {size} bytes on the wire, at most {MOST_BYTES_LIVE} are possible while the "
            "robot runs"
        )
    movers = sum(o.moves for o in after)
    if movers > MOST_MOVERS:
        return (), f"{movers} obstacles would move, at most {MOST_MOVERS} are possible while the robot runs"
    return after, ""


def _first_twice(names: Sequence[str]) -> str:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            return name
        seen.add(name)
    return ""
