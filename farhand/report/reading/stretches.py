"""Stretches of what happened: what comes again and again within a short time, taken as one."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from farhand.foxglove.happenings import OVER_NS
from farhand.report.reading.figures import LASTING, Happened
from farhand.report.reading.spans import joined, seconds_of
from farhand.runs.words.refusals import meaning

TOGETHER = 1.0
"""What comes again within so long is told in the same row (s)."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """Attributes:
    number: of its first event, which names its row.
    kind: of all its events.
    begin, end: from and to (s).
    seconds: in which it was so, breaks left out.
    lines: of words.
    """

    number: int
    kind: str
    begin: float
    end: float
    seconds: float
    lines: tuple[str, ...]


def stretches(events: Sequence[Happened]) -> list[Stretch]:
    """All events, in the order of their beginnings; a stretch ends where a stop of the robot begins or ends."""
    edges = [at for each in events if each.kind == "stop" for at in (each.begin, each.end)]
    groups: list[list[int]] = []
    going: dict[str, tuple[list[int], float, int]] = {}
    for number, each in enumerate(events):
        side = sum(at <= each.begin for at in edges)
        group, end, last = going.get(each.kind, ([], 0.0, -1))
        together = each.kind in LASTING or each.kind == "refused"
        if not (together and group and side == last and each.begin <= end + TOGETHER):
            group, end = [], each.end
            groups.append(group)
        group.append(number)
        going[each.kind] = group, max(end, each.end), side
    return [_stretch(group, [events[k] for k in group]) for group in groups]


def _stretch(group: Sequence[int], events: Sequence[Happened]) -> Stretch:
    kind, begin, end = events[0].kind, events[0].begin, max(each.end for each in events)
    pieces = joined(((each.begin, each.end) for each in events), OVER_NS * 1e-9)
    seconds = seconds_of(pieces)
    if kind == "refused":
        lines = _refused(events)
    elif len(events) == 1:
        lines = [events[0].words]
    else:
        head = [f"{len(pieces)} times until {end:.1f} s:"] if len(pieces) > 1 else []
        lines = head + _reasons(events)
    return Stretch(group[0], kind, begin, end, seconds, tuple(lines))


def _reasons(events: Iterable[Happened]) -> list[str]:
    """Each once, with how often and how long."""
    found: dict[str, list[tuple[float, float]]] = {}
    for each in events:
        found.setdefault(each.words, []).append((each.begin, each.end))
    lines = []
    for words, spans in found.items():
        seconds = seconds_of(spans)
        said = [f"{len(spans)} times"] if len(spans) > 1 else []
        said += [f"{seconds:.1f} s"] if seconds >= 0.05 else []
        lines.append(words + (f" ({', '.join(said)})" if said else ""))
    return lines


def _refused(events: Sequence[Happened]) -> list[str]:
    """How many, and the reasons with their counts and meanings."""
    counts: dict[str, int] = {}
    for each in events:
        for reason, count in reasons_of(each.facts).items():
            counts[reason] = counts.get(reason, 0) + count
    total = sum(int(each.facts.get("commands", "1")) for each in events)
    head = f"the robot refused {total} command{'s' if total > 1 else ''}"
    if sum(counts.values()) != total:  # of some it is not known which reason was theirs
        return [f"{head}: {events[-1].words}"]
    return [f"{head}:", *(f"{reason} {count}: {meaning(reason)}" for reason, count in counts.items())]


def reasons_of(facts: dict[str, str]) -> dict[str, int]:
    """Commands that were refused, by reason, of an event's facts."""
    pairs = (each.rsplit(" ", 1) for each in facts.get("reasons", "").split(", ") if each)
    return {reason: int(count) for reason, count in pairs}
