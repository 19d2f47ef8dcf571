"""What comes again and again is one row, with the reasons, how often and how long."""

import re
from pathlib import Path

from farhand.report.reading.evidence import Evidence
from farhand.report.reading.figures import Happened, figures_of
from farhand.report.reading.stretches import stretches
from farhand.runs.words.refusals import MEANINGS, meaning
from farhand.testing import report, state
from tests.farhand.report.test_story import told


def event(kind, begin, end, words="", **facts):
    return Happened(kind=kind, begin=begin, end=end, words=words, facts=facts)


def test_reasons_in_turn_are_one_row_until_a_stop_of_the_robot():
    events = [
        event("hold", 1.0, 1.4, "silent"),
        event("hold", 1.5, 1.9, "nothing held"),
        event("hold", 2.0, 2.4, "silent"),
        event("stop", 2.45, 9.0, "stopped"),
        event("hold", 2.5, 2.8, "silent"),
        event("hold", 3.5, 4.5, "nothing held"),
        event("hold", 9.1, 9.2, "acknowledged"),
        event("guard", 9.3, 9.4, "guard slowed"),
        event("guard", 9.8, 9.9, "guard slowed"),
    ]
    found = stretches(events)
    assert [(each.number, each.kind, each.lines) for each in found] == [
        (0, "hold", ("silent (2 times, 0.8 s)", "nothing held (0.4 s)")),
        (3, "stop", ("stopped",)),
        (4, "hold", ("2 times until 4.5 s:", "silent (0.3 s)", "nothing held (1.0 s)")),
        (6, "hold", ("acknowledged",)),
        (7, "guard", ("guard slowed",)),
        (8, "guard", ("guard slowed",)),
    ]
    assert [f"{each.seconds:.1f}" for each in found[:3]] == ["1.4", "6.5", "1.3"]


def test_refusals_are_one_row_with_counts_by_reason():
    counts = [{}, {"stale": 1}, {"stale": 3}, {"stale": 3, "held": 1}] + 20 * [{"stale": 3, "held": 1}]
    counts.append({"stale": 4, "held": 1})
    states = [(n, state(n, refused=refused)) for n, refused in enumerate(counts)]
    found = figures_of(Evidence("x", told([report(n) for n in range(30)], states)))
    first, last = stretches(found.events)
    assert len(found.events) == 4
    assert first.lines == (
        "the robot refused 4 commands:",
        f"stale 3: {meaning('stale')}",
        f"held 1: {meaning('held')}",
    )
    assert last.lines == ("the robot refused 1 command:", f"stale 1: {meaning('stale')}")


def test_every_reason_the_robot_has_is_explained_and_stands_in_the_document():
    root = Path(__file__).parents[3]
    page = (root / "docs" / "recordings.md").read_text()
    assert all(f"| `{reason}` | {words} |" in page for reason, words in MEANINGS.items())
    safety = root / "robot_side" / "safety"
    given = set(
        re.findall(r'(?:return|return stale or|else) "([a-z-]+)"', (safety / "watchdog.py").read_text())
    )
    assert given - {"acknowledged"} <= set(MEANINGS)
    assert {
        "foreign-session",
        "held",
        "old-seq",
        "stale",
        "too-fast",
        "turns-too-fast",
        "unseen-stop",
    } <= given
