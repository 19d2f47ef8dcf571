"""Spans of time that overlap, counted once."""

from collections.abc import Iterable

Span = tuple[float, float]


def joined(spans: Iterable[Span], gap: float = 0.0) -> list[Span]:
    """Those that overlap, or are at most `gap` apart (s), as one; in order."""
    found: list[Span] = []
    for begin, end in sorted(spans):
        if found and begin <= found[-1][1] + gap:
            found[-1] = found[-1][0], max(end, found[-1][1])
        else:
            found.append((begin, end))
    return found


def seconds_of(spans: Iterable[Span]) -> float:
    """The length of all of them together (s)."""
    return sum(end - begin for begin, end in spans)
