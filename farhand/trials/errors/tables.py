"""The table of the trial, and what must hold of it."""

import statistics
from collections import Counter
from collections.abc import Sequence

from farhand.robot_side.safety.guard.settings import GuardSettings
from farhand.trials.errors.errors import ERRORS, Injected
from farhand.trials.errors.running import Row

OLDEST = 1.0
"""s: `safety.max_age`; beyond it nothing may move the robot."""
MARK = "†"
MARKED = (
    f"{MARK}: a lawful session is forged in all its fields, which no check of a message can notice. Motion that "
    "is not explained does not count as a failure there; all else does: too near to an "
    "obstacle, a basis too old, a crash."
)


def broken(rows: Sequence[Row]) -> list[str]:
    """What does not hold, a line a run; empty: all holds."""
    found = []
    for row in rows:
        injected = ERRORS[row.name]
        if row.error:
            found.append(f"{row.key}: crashed: {row.error}")
        if row.unexplained and not injected.insider:
            found.append(f"{row.key}: {row.unexplained} periods at up to "
                         f"{row.fastest_unexplained:.2f} m/s that no fresh lawful command explains")  # fmt: skip
        if row.oldest > OLDEST:
            found.append(f"{row.key}: moved by a command built on a state {row.oldest:.2f} s old")
        if row.clearance is not None and row.clearance < GuardSettings().d_min:
            found.append(f"{row.key}: {1e3 * row.clearance:.1f} mm to an obstacle")
    return found


def to_markdown(rows: Sequence[Row]) -> str:
    """The table, and below it what the mark means and what does not hold."""
    lines = [
        "| error | id | injected | runs | noticed by the robot as | refused by the operator's side | "
        "when it ends the robot | stands after, s: median, most | "
        "motion not explained | oldest basis, s | drives again |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for name, injected in ERRORS.items():
        mine = [row for row in rows if row.name == name and not row.error]
        if mine:
            lines.append("| " + " | ".join(_cells(name, injected, mine)) + " |")
    if any(ERRORS[row.name].insider for row in rows):
        lines += ["", MARKED]
    wrong = broken(rows)
    if wrong:
        lines += ["", "What does not hold:", "", *(f"- {line}" for line in wrong[:100])]
    return "\n".join(lines) + "\n"


def _cells(name: str, injected: Injected, rows: Sequence[Row]) -> list[str]:
    stood = [row.standing for row in rows if row.standing is not None]
    modes = Counter(row.mode for row in rows)
    unexplained = sum(row.unexplained > 0 for row in rows)
    fastest = max(row.fastest_unexplained for row in rows)
    guarded = [row.clearance for row in rows if row.clearance is not None]
    near = f"by the guard; {1e3 * min(guarded):.1f} mm to an obstacle at least" if guarded else ""
    return [
        injected.error,
        f"`{name}`",
        injected.how + (f" {MARK}" if injected.insider else ""),
        str(len(rows)),
        _reasons(rows),
        f"{statistics.fmean(row.refused_here for row in rows):.0f}",
        ", ".join(f"{mode} {count}" for mode, count in modes.most_common()),
        f"{statistics.median(stood):.2f}, {max(stood):.2f} ({len(stood)} runs)" if stood else "drives on",
        near if guarded else f"{unexplained}, up to {fastest:.2f} m/s" if unexplained else "0",
        f"{max(row.oldest for row in rows):.2f}",
        str(sum(row.again for row in rows)),
    ]


def _reasons(rows: Sequence[Row]) -> str:
    """Why commands were refused, those that were most, in the mean of the runs."""
    total: Counter[str] = Counter()
    for row in rows:
        total.update(row.refused)
    each = [(why, count / len(rows)) for why, count in total.most_common(3)]
    return ", ".join(f"{why} {count:.0f}" for why, count in each if count >= 0.5) or "–"
