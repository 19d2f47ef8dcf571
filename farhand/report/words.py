"""Quantities and verdicts of the report in words."""

from collections.abc import Mapping
from html import escape

from farhand.report.reading.figures import Figures, Spread, Way

UNKNOWN = "unknown"


def mm(value: float | None) -> str:
    """Metres as millimetres."""
    return UNKNOWN if value is None else f"{value * 1e3:.1f} mm"


def ms(value: float | None) -> str:
    """Seconds as milliseconds."""
    return UNKNOWN if value is None else f"{value * 1e3:.3g} ms" if value < 0.1 else f"{value * 1e3:.0f} ms"


def share(value: float | None) -> str:
    """Of a hundred."""
    return UNKNOWN if value is None else f"{value * 100:.2f} %"


def spread_ms(found: Spread | None) -> str:
    """Median, the 99th of a hundred and the largest."""
    return UNKNOWN if found is None else f"{ms(found.p50)} · {ms(found.p99)} · {ms(found.max)}"


def spread_mm(found: Spread | None) -> str:
    """The same of lengths."""
    return UNKNOWN if found is None else f"{mm(found.p50)} · {mm(found.p99)} · {mm(found.max)}"


def length(seconds: float) -> str:
    """`14.8 s`, `12 min 3 s`, `1 h 0 min`."""
    if seconds < 120.0:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest} s" if minutes < 60 else f"{minutes // 60} h {minutes % 60} min"


def network(found: Figures) -> str:
    """`5g-urban`, or both directions."""
    if found.uplink is None and found.downlink is None:
        return "a network that the recording does not name"
    if found.uplink == found.downlink:
        return str(found.uplink)
    return f"{found.uplink or UNKNOWN} / {found.downlink or UNKNOWN}"


def badges(found: Figures) -> str:
    """The verdict as HTML."""
    if found.safe is None:
        safe = ("open", "SAFE OR NOT: UNKNOWN")
    else:
        safe = ("good", "SAFE") if found.safe else ("bad", "NOT SAFE")
    if found.finished is None:
        done = ""
    else:
        done = _badge("good", "FINISHED") if found.finished else _badge("open", "NOT FINISHED")
    return _badge(*safe) + done


def _badge(look: str, text: str) -> str:
    return f'<span class="verdict {look}">{text}</span>'


def result(found: Figures) -> str:
    """What came of it, in a line of plain text."""
    parts = []
    if found.targets:
        took = f" in {length(found.duration)}" if found.duration is not None else ""
        parts.append(
            f"{found.targets_reached} of {found.targets} targets{took}{_by(found, 'targets_reached')}"
        )
    else:
        parts.append(f"targets {UNKNOWN}, {length(found.recorded)} recorded")
    if found.clearance is not None:
        limit = f" (limit {found.limit * 1e3:g} mm)" if found.limit is not None else ""
        parts.append(f"least clearance {mm(found.clearance)}{limit}{_by(found, 'clearance')}")
    return ", ".join(parts) + (f"; {found.why}" if found.why else "")


def _by(found: Figures, name: str) -> str:
    """Whose word it is, where not all of the run is recorded and the sources may differ."""
    if found.whole:
        return ""
    source = found.sources.get(name)
    return f" by the {source}" if source else " as recorded"


def what(found: Figures) -> str:
    """What, who and when, as HTML."""
    when = found.began or (
        "in virtual time" if found.clock == "virtual" else "at a time that is not recorded"
    )
    return (
        f"robot {escape(found.robot)} driven by {escape(found.operator)} over {escape(network(found))}, "
        f"margin {escape(found.margin or UNKNOWN)}; {escape(when)}; 0 s: {escape(found.zero)}"
    )


def lost(way: Way | None) -> str:
    """`2 of 150 (trace 2)`."""
    if way is None:
        return "not recorded"
    count = sum(way.lost.values())
    why = ", ".join(f"{cause} {n}" for cause, n in way.lost.items())
    return f"{count} of {way.messages} ({why})" if count else f"none of {way.messages}"


def refusals(count: int, reasons: Mapping[str, int] | None) -> str:
    """`4 commands: old-seq 3, stale 1`."""
    said = "1 command" if count == 1 else f"{count} commands"
    why = ", ".join(f"{reason} {n}" for reason, n in (reasons or {}).items())
    return f"{said}: {why}" if why else said


def value(node: object) -> str:
    """A setting."""
    if node is None:
        return "–"
    if isinstance(node, bool):
        return "on" if node else "off"
    if isinstance(node, float):
        return f"{node:g}"
    if isinstance(node, list | tuple):
        text = "[" + ", ".join(value(each) for each in node) + "]"
        return text if len(text) <= 120 else f"{text[:110]} … ({len(node)} entries)"
    if isinstance(node, dict):
        text = "{" + ", ".join(f"{k}: {value(v)}" for k, v in node.items()) + "}"
        return text if len(text) <= 120 else f"{text[:110]} …"
    return str(node)
