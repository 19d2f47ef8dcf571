"""What happened, told when it begins and when it ends: interventions, stops and refusals, as lines and as spans."""

from collections.abc import Iterator
from dataclasses import dataclass, field

from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.runs.words.guard import guard_words
from farhand.runs.words.scene import scene_words

OVER_NS = 300_000_000
"""What is not seen again for so long is over: the guard is told of once a state, the filter once a tick."""


@dataclass(slots=True)
class Happening:
    """Attributes:
    kind: `filter`, `guard`, `stop`, `refused`, `held`, `scene`.
    words: for people.
    began_ns, seen_ns: first and newest instant at which it was so (operator's clock).
    facts: numbers and names, as text.
    """

    kind: str
    words: str
    began_ns: int
    seen_ns: int
    facts: dict[str, str] = field(default_factory=dict)


class Happenings:
    """Follows a run; spans of one kind that touch are one. Wants news alone: what was overtaken is no change."""

    def __init__(self) -> None:
        self._going: dict[str, Happening] = {}
        self._session = 0
        self._refused: dict[str, int] = {}
        self._scene: Scene | None = None

    def tick(self, report: ControlReport, now_ns: int) -> Iterator[Happening]:
        """What is over with this tick."""
        if report.intervening and report.mode == "run":
            whom = f" for {report.binding}" if report.binding else ""
            self._see("filter", f"the filter intervenes{whom}", now_ns, binding=report.binding)
        if report.stop_reason:
            yield from self._change("stop", report.stop_reason, now_ns, mode=report.mode)
        if report.held_by:
            yield from self._change(
                "held", f"no progress: held by {report.held_by}", now_ns, by=report.held_by
            )
        if report.guard is not None:
            did = report.guard
            self._see(
                "guard",
                guard_words(did),
                now_ns,
                part=did.part,
                obstacle=did.obstacle,
                distance=f"{did.distance:.4f}",
                what=did.what,
            )
        yield from self._over(now_ns)

    def state(self, state: RobotState, now_ns: int) -> Iterator[Happening]:
        """Commands that the robot refused since the state before; one that was started anew counts anew."""
        if state.session != self._session:
            self._session, self._refused = state.session, {}
        new = {
            reason: count - self._refused.get(reason, 0)
            for reason, count in state.refused.items()
            if count > self._refused.get(reason, 0)
        }
        self._refused = state.refused
        total = sum(new.values())
        if total:
            so_far = ", ".join(f"{reason} {count}" for reason, count in state.refused.items())
            yield Happening(
                "refused",
                f"the robot refused {total} command{'s' if total > 1 else ''} (so far: {so_far})",
                now_ns,
                now_ns,
                {
                    "commands": str(total),
                    "reasons": ", ".join(f"{reason} {count}" for reason, count in new.items()),
                },
            )

    def scene(self, scene: Scene, now_ns: int) -> Iterator[Happening]:
        """A change of the obstacles since the scene before."""
        if scene.overtaken_by(self._scene):
            return
        words, self._scene = scene_words(self._scene, scene), scene
        if words:
            yield Happening("scene", words, now_ns, now_ns, {"revision": str(scene.changes)})

    def end(self) -> Iterator[Happening]:
        """What is going on when nothing more comes."""
        yield from self._going.values()
        self._going.clear()

    @property
    def begun(self) -> list[Happening]:
        """What is going on."""
        return list(self._going.values())

    def _see(self, kind: str, words: str, now_ns: int, **facts: str) -> None:
        going = self._going.get(kind)
        if going is None:
            self._going[kind] = Happening(kind, words, now_ns, now_ns, facts)
        else:
            going.seen_ns = now_ns

    def _change(self, kind: str, words: str, now_ns: int, **facts: str) -> Iterator[Happening]:
        """The same, where another reason is another happening."""
        going = self._going.get(kind)
        if going is not None and going.words != words:
            yield self._going.pop(kind)
        self._see(kind, words, now_ns, **facts)

    def _over(self, now_ns: int) -> Iterator[Happening]:
        for kind, going in list(self._going.items()):
            if now_ns - going.seen_ns > OVER_NS:
                yield self._going.pop(kind)
