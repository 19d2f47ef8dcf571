"""The tables of the report: figures of one run or two, settings, what happened."""

from collections.abc import Sequence
from html import escape

from farhand.report.reading.evidence import Evidence
from farhand.report.reading.figures import Figures
from farhand.report.reading.settings import differing
from farhand.report.reading.stretches import Stretch, stretches
from farhand.report.rows import Row
from farhand.report.words import refusals, value
from farhand.runs.words.guard import guard_summary
from farhand.runs.words.refusals import meaning

MOST_EVENTS = 300
BEFORE_ALL = ("stop", "refused", "guard")
"""Told of first where not everything can be."""


def figures(runs: Sequence[Figures], rows: Sequence[Row]) -> str:
    """A line for each figure, a column for each run."""
    head = "<tr><th></th>" + "".join(f"<th>{escape(each.name)}</th>" for each in runs) + "</tr>"
    body = "".join(
        f"<tr><td>{escape(label)}</td>" + "".join(f"<td>{escape(tell(each))}</td>" for each in runs) + "</tr>"
        for label, tell in rows
    )
    return f'<div class="wide"><table>{head if len(runs) > 1 else ""}{body}</table></div>'


def guard_line(run: Evidence) -> str:
    """What the guard did by the robot's own count; empty where unknown."""
    pairs = run.summary.guard_pairs if run.summary is not None else []
    return guard_summary(run.robot, pairs) if run.robot is not None else ""


def changed(found: Figures) -> str:
    """Settings that are not the defaults."""
    if not found.changed:
        return "<p>All settings are the defaults.</p>"
    rows = "".join(
        f"<tr><td>{escape(key)}</td><td>{escape(value(now))}</td><td>{escape(value(default))}</td></tr>"
        for key, (now, default) in found.changed.items()
    )
    return f'<div class="wide"><table><tr><th>setting</th><th>in force</th><th>default</th></tr>{rows}</table></div>'


def differences(first: Evidence, second: Evidence) -> str:
    """Settings in which two runs differ."""
    found = differing(first.story.info.scenario, second.story.info.scenario)
    found |= {
        name: (one, other)
        for name, one, other in (
            ("seed", first.story.info.seed, second.story.info.seed),
            ("git", first.story.info.git, second.story.info.git),
            ("clock", first.story.info.clock, second.story.info.clock),
        )
        if one != other
    }
    if not found:
        return "<p>Task, settings and seed are the same.</p>"
    rows = "".join(
        f"<tr><td>{escape(key)}</td><td>{escape(value(one))}</td><td>{escape(value(other))}</td></tr>"
        for key, (one, other) in found.items()
    )
    names = f"<th>{escape(first.name)}</th><th>{escape(second.name)}</th>"
    return f'<div class="wide"><table><tr><th>setting</th>{names}</tr>{rows}</table></div>'


def told(found: Figures) -> list[Stretch]:
    """What is in the table: all, or the gravest and the longest, in order."""
    all_of_them = stretches(found.events)
    weighed = sorted(all_of_them, key=lambda each: (each.kind not in BEFORE_ALL, each.begin - each.end))
    return sorted(weighed[:MOST_EVENTS], key=lambda each: each.number)


def events(found: Figures, shown: Sequence[Stretch], prefix: str) -> str:
    """A line for each stretch."""
    unseen = _unseen(found)
    if not found.events:
        if not found.whole:
            return f"<p>Nothing in what is recorded, which is not all of the run.</p>{unseen}"
        return unseen or "<p>Nothing: no intervention, no stop, no refusal.</p>"
    rows = []
    for each in shown:
        lasted = f"{each.seconds:.1f} s" if each.seconds >= 0.05 else "–"
        rows.append(
            f'<tr id="{prefix}{each.number + 1}"><td class="when">{each.begin:.1f} s</td>'
            f'<td class="when">{lasted}</td><td><span class="tag {each.kind}">{each.kind}</span></td>'
            f"<td>{'<br>'.join(escape(line) for line in each.lines)}</td></tr>"
        )
    left = len(stretches(found.events)) - len(shown)
    more = (
        f'<p class="said">{left} more are in the JSON alone: shorter ones of filter and waiting.</p>'
        if left
        else ""
    )
    head = "<tr><th>at</th><th>for</th><th></th><th>what</th></tr>"
    return f'<div class="wide"><table class="events">{head}{"".join(rows)}</table></div>{more}{unseen}'


def _unseen(found: Figures) -> str:
    """Refusals that the robot counted and of which no state told that was recorded, as of those after the last."""
    if not found.refused or "refused" in found.happened:
        return ""
    said = refusals(found.refused, found.refused_by)
    meant = "; ".join(f"{reason}: {meaning(reason)}" for reason in found.refused_by or {})
    why = f" ({escape(meant)})" if meant else ""
    return (
        f'<p class="said">The robot refused {escape(said)}{why}, as it counted: no recorded state tells when, as '
        "where the last came before.</p>"
    )
