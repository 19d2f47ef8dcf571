"""What was measured, in words."""

import statistics
from collections.abc import Iterator
from typing import Any

TICK, BEYOND = 0.02, 0.015
"""Of the controller, and what may be added to it (s)."""
GHOST_WITHIN = 0.05
SHARE, LATER = 0.10, 1.2


def summary(found: list[float]) -> dict[str, float]:
    if not found:
        return {"count": 0}
    ordered = sorted(found)
    return {
        "count": len(found),
        "median": statistics.median(found),
        "p90": ordered[min(len(ordered) - 1, round(0.9 * len(ordered)))],
        "max": ordered[-1],
    }


def _told(found: dict[str, float]) -> str:
    if not found["count"]:
        return "none"
    return (
        f"median {found['median'] * 1e3:.1f} ms, 90 % within {found['p90'] * 1e3:.1f}, "
        f"at most {found['max'] * 1e3:.1f} ({found['count']:.0f})"
    )


def lines(found: dict[str, Any]) -> Iterator[str]:
    for name, each in found["share"].items():
        yield f"console, {name:14s} {each['share'] * 100:5.1f} % of a core (at most {SHARE * 100:.0f}){_at(each)}"
    pressed, page = found["press"], found["browser"]
    over = f"{pressed['over']} over {(TICK + BEYOND) * 1e3:.0f} ms, {pressed['missed']} missed"
    yield f"press at the socket to command   {_told(pressed)}; {over}{_at(pressed)}"
    if page is not None:
        yield f"key in Chromium to command       {_told(page['command'])}; {page['missed']} missed{_at(page)}"
        yield f"key in Chromium to drawn ghost   {_told(page['ghost'])} (at most {GHOST_WITHIN * 1e3:.0f})"
    medians = found["late"]["medians"]
    for what, ratio in found["late"]["ratios"].items():
        without, there = (medians[name][what] * 1e3 for name in ("without", "with"))
        yield (
            f"{what:10s} late by p99 {without:.2f} ms without, {there:.2f} ms with console, camera and recorder: "
            f"{ratio:.2f} (at most {LATER}){_at(medians['without'])}{_at(medians['with'])}"
        )


def _at(found: dict[str, float]) -> str:
    return f"   load {found['load']:.1f}"
