"""The rows of the tables of figures, and how each reads."""

from collections.abc import Callable, Sequence

from farhand.report.reading.figures import Figures
from farhand.report.words import UNKNOWN, length, lost, mm, ms, refusals, share, spread_mm, spread_ms

Row = tuple[str, Callable[[Figures], str]]


def _times(found: Figures, kind: str, did: str) -> str:
    """As recorded; of what is not recorded nobody knows."""
    times, seconds = found.happened.get(kind, (0, 0.0))
    if found.whole:
        return _said(did, times, seconds)
    return f"{_said(did, times, seconds)} in what is recorded" if times else UNKNOWN


def _said(did: str, times: int, seconds: float) -> str:
    if not times:
        return "never"
    how = "once" if times == 1 else f"{times} times"
    return f"{did} {how}".strip() + (f", {length(seconds)} in all" if seconds >= 0.05 else "")


def _by(found: Figures, name: str, said: str) -> str:
    """With whose word it is, where it is not that of a recording that is whole."""
    source = found.sources.get(name)
    if source:
        return f"{said} ({source})"
    return said if found.whole else f"{said} as recorded"


def _filter(found: Figures) -> str:
    if found.whole or found.filtered_ticks is None:
        return _times(found, "filter", "intervened")
    said = f"intervened in {found.filtered_ticks} ticks" if found.filtered_ticks else "never"
    return _by(found, "filtered_ticks", said)


def _guard(found: Figures) -> str:
    """By the robot's own count, which sees it at its own rate; else by what its states told."""
    if found.guard is None:
        return _times(found, "guard", "acted")
    return _by(found, "guard", _said("acted", *found.guard))


def _stops(found: Figures) -> str:
    """As the robot counted: of one that nobody saw for want of states no event tells."""
    known = found.whole or "stops" in found.sources
    if found.stops is None or not (found.stops or known):
        return UNKNOWN
    return _by(found, "stops", f"{found.stops}" if found.stops else "none")


def _refused(found: Figures) -> str:
    if found.refused is None or "refused" not in found.sources:
        return _times(found, "refused", "")
    return _by(found, "refused", refusals(found.refused, found.refused_by) if found.refused else "never")


def _arm(found: Figures) -> str:
    if found.arm_clearance is not None:
        return _by(found, "arm_clearance", mm(found.arm_clearance))
    return "not computed" if found.states or "arm_clearance" in found.sources else UNKNOWN


def _clearance(found: Figures) -> str:
    return UNKNOWN if found.clearance is None else _by(found, "clearance", mm(found.clearance))


def _late_ticks(found: Figures) -> str:
    return UNKNOWN if found.overruns is None else _by(found, "overruns", str(found.overruns))


def _coverage(found: Figures) -> str:
    if found.coverage is None:
        return "unknown"
    judged, held = found.coverage
    return f"in {share(held)} of {judged} ticks"


def _lost(found: Figures, name: str) -> str:
    """As recorded; beside it the emulator's own count, where that is another one."""
    way, counted = found.network.get(name), found.emulator.get(name)
    if counted is None or (way is not None and counted == (way.messages, sum(way.lost.values()))):
        return lost(way)
    messages, gone = counted
    said = f"{gone or 'none'} of {messages} as the emulator counted from its start to its end"
    return f"{said}; not recorded" if way is None else f"{said}; of those recorded {lost(way)}"


def _delay(found: Figures, way: str) -> str:
    known = found.network.get(way)
    return spread_ms(known.delay) if known is not None else "not recorded"


def _tick_late(found: Figures) -> str:
    return "not measured in virtual time" if found.clock == "virtual" else spread_ms(found.tick_late)


def _robot_loop(found: Figures) -> str:
    if found.robot_loop is None:
        return "not measured in virtual time" if found.clock == "virtual" else "unknown"
    return " · ".join(map(ms, found.robot_loop))


SAFETY: Sequence[Row] = (
    ("clearance of the tool, least", _clearance),
    ("clearance of the bare arm, least", _arm),
    ("limit", lambda f: mm(f.limit)),
    ("filter", _filter),
    ("guard", _guard),
    ("stops of the robot", _stops),
    ("held, or commanded zero", lambda f: _times(f, "hold", "")),
    ("no progress", lambda f: _times(f, "stuck", "")),
    ("refusals by the robot", _refused),
)
MARGIN: Sequence[Row] = (
    ("width: median · 99 % · largest", lambda f: spread_mm(f.margin_width)),
    ("error of the prediction", lambda f: spread_mm(f.prediction_error)),
    ("coverage: error within the margin before it", _coverage),
    (
        "parts, mean",
        lambda f: (
            ", ".join(f"{name} {mm(part)}" for name, part in f.margin_parts.items())
            or ("none" if f.margin_width is not None else UNKNOWN)
        ),
    ),
)
LINK: Sequence[Row] = (
    ("round trip: median · 99 % · largest", lambda f: spread_ms(f.round_trip)),
    ("oldest command without an answer", lambda f: spread_ms(f.age)),
    ("since the newest state came", lambda f: spread_ms(f.state_age)),
    ("states that never arrived", lambda f: share(f.loss)),
    ("lost in the emulator, uplink", lambda f: _lost(f, "uplink")),
    ("lost in the emulator, downlink", lambda f: _lost(f, "downlink")),
    ("delay in the emulator, uplink", lambda f: _delay(f, "uplink")),
    ("delay in the emulator, downlink", lambda f: _delay(f, "downlink")),
)
TIMING: Sequence[Row] = (
    ("operator's tick, period", lambda f: ms(f.period)),
    ("tick late: median · 99 % · largest", _tick_late),
    ("late ticks, as it counted", _late_ticks),
    ("solver", lambda f: "not measured in virtual time" if f.clock == "virtual" else spread_ms(f.solve)),
    ("robot's loop late", _robot_loop),
)
