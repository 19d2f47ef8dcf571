"""What filter and guard did in each of their interventions, in numbers and words; the robot's own changes of mode."""

from bisect import bisect_left, bisect_right
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Generic, TypeVar

from farhand.common.geometry import norm
from farhand.common.messages.intervention import Intervention
from farhand.common.messages.report import ControlReport
from farhand.common.messages.state import RobotState
from farhand.foxglove.happenings import Happening
from farhand.runs.words.guard import guard_words
from farhand.runs.words.standing import standing_words


@dataclass(slots=True)
class _Filtered:
    """A tick in which the filter had a hand."""

    binding: str
    asked: float
    done: float
    change: float
    clearance: float | None
    margin: float
    status: str


T = TypeVar("T")


class _Timed(Generic[T]):
    """Things with their instants, in order."""

    def __init__(self) -> None:
        self._instants: list[int] = []
        self._things: list[T] = []

    def add(self, at_ns: int, thing: T) -> None:
        self._instants.append(at_ns)
        self._things.append(thing)

    def within(self, each: Happening) -> list[T]:
        """Those of a happening's time."""
        first = bisect_left(self._instants, each.began_ns)
        return self._things[first : bisect_right(self._instants, each.seen_ns)]


class Deeds:
    """Notes what was done while a run is read, and says it of its happenings at the end."""

    def __init__(self) -> None:
        self._filtered: _Timed[_Filtered] = _Timed()
        self._guarded: _Timed[Intervention] = _Timed()
        self._drove = 1 << 63, 0
        self._done = False
        self._mode: str | None = None
        self._modes: list[Happening] = []

    def tick(self, report: ControlReport, now_ns: int) -> None:
        """Note a tick."""
        if report.mode == "run":
            self._drove = min(self._drove[0], now_ns), now_ns
        self._done = 0 < report.target_count <= report.target_index and report.safety in ("run", "hold")
        if report.guard is not None:
            self._guarded.add(now_ns, report.guard)
        if not (report.intervening and report.mode == "run"):
            return
        change = norm(
            (
                report.desired[0] - report.filtered[0],
                report.desired[1] - report.filtered[1],
                report.desired[2] - report.filtered[2],
            )
        )
        self._filtered.add(
            now_ns,
            _Filtered(
                report.binding,
                norm(report.desired),
                norm(report.filtered),
                change,
                report.clearance,
                report.inflation,
                report.status,
            ),
        )

    def state(self, state: RobotState, now_ns: int) -> None:
        """Note its mode: times in which it is stopped, or holds after it ran."""
        told = "" if state.mode == "run" else _mode_words(state)
        if self._mode is None and state.mode == "hold":
            return  # nobody has driven it yet
        self._mode = state.mode
        last = self._modes[-1] if self._modes else None
        if last is not None and not last.facts:
            if last.words == told:
                last.seen_ns = now_ns
                return
            last.seen_ns = now_ns
            last.facts["mode"] = last.kind
        if told:
            self._modes.append(Happening(state.mode, told, now_ns, now_ns))

    def explain(self, happenings: list[Happening]) -> None:
        """Say in each of them what was done, and add the robot's own; they stay in the order of their beginnings.

        What the operator's side waited for before it first drove, and at the end of a task that was done, is a `wait`;
        when it commanded zero meanwhile, or the robot held, a `hold`; a `stop` is the robot's own, which latches.
        """
        first, last = self._drove
        for each in happenings:
            if each.kind == "filter":
                self._explain_filter(each)
            elif each.kind == "guard":
                self._explain_guard(each)
            elif each.kind == "stop":
                done = self._done and each.began_ns > last
                waited = each.began_ns < first or done
                each.words = standing_words(each.words, done=done)
                each.kind = "wait" if waited else "hold"
            elif each.kind == "held":
                each.kind = "stuck"
        for each in self._modes:
            each.facts.setdefault("mode", each.kind)
            each.kind = "hold" if each.facts["mode"] == "hold" else "stop"
        happenings.extend(self._modes)
        happenings.sort(key=lambda each: (each.began_ns, each.kind, each.words))

    def _explain_filter(self, each: Happening) -> None:
        ticks = self._filtered.within(each)
        if not ticks:
            return
        most = max(ticks, key=lambda tick: tick.change)
        whom = " and ".join(dict.fromkeys(repr(tick.binding) for tick in ticks if tick.binding))
        deed = _filter_deed(most)
        words = f"filter {deed}{f' for {whom}' if whom else ''}: {_speeds(most.asked, most.done)}"
        near = [tick.clearance for tick in ticks if tick.clearance is not None]
        if near:
            words += (
                f"; clearance {_mm(min(near))} at least, margin up to {_mm(max(t.margin for t in ticks))}"
            )
            each.facts["clearance"] = f"{min(near):.4f}"
        bad = sorted({tick.status for tick in ticks} - {"optimal", "shortcut", "idle"})
        if bad:
            words += f"; solver: {', '.join(bad)}"
        each.words = words
        each.facts |= {"asked": f"{most.asked:.4f}", "done": f"{most.done:.4f}"}

    def _explain_guard(self, each: Happening) -> None:
        deeds = self._guarded.within(each)
        if not deeds:
            return
        nearest = min(deeds, key=lambda did: did.distance - did.limit)
        pairs = dict.fromkeys((did.part, did.obstacle) for did in deeds)
        others = len(pairs) - 1
        each.words = f"guard {guard_words(nearest)}" + (
            f"; and {others} further pair{'s' if others > 1 else ''}" if others else ""
        )
        each.facts |= {
            "part": nearest.part,
            "obstacle": nearest.obstacle,
            "distance": f"{nearest.distance:.4f}",
            "limit": f"{nearest.limit:.4f}",
            "asked": f"{nearest.asked:.4f}",
            "done": f"{nearest.done:.4f}",
            "what": nearest.what,
        }


def _mode_words(state: RobotState) -> str:
    how = {
        "hold": "the robot holds",
        "stopped": "the robot stopped",
        "estop": "the robot is in emergency stop",
    }
    return f"{how.get(state.mode, state.mode)}: {state.reason}"


def _filter_deed(tick: _Filtered) -> str:
    if tick.change < 1e-3:
        return "watched, and changed nothing"
    if tick.done < 1e-3:
        return "stopped the tool"
    return "slowed the tool" if tick.done < 0.95 * tick.asked else "turned the tool aside"


def _speeds(asked: float, done: float) -> str:
    return f"{asked:.2f} m/s asked, {done:.2f} m/s done"


def _mm(metres: float) -> str:
    return f"{metres * 1e3:.0f} mm"


def kinds(happenings: Iterable[Happening]) -> dict[str, int]:
    """How many of each kind."""
    found: dict[str, int] = {}
    for each in happenings:
        found[each.kind] = found.get(each.kind, 0) + 1
    return found
