"""What a check found, one line each, and how it is printed: for the path to a robot, and for a real arm."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass

from rich.table import Table

from farhand.common.process.console import page, whole


@dataclass(frozen=True, slots=True)
class Finding:
    """One line: level good, note or bad; what was looked at; what was found; what to do."""

    level: str
    what: str
    found: str
    remedy: str = ""


def print_findings(title: str, findings: Sequence[Finding], *, as_json: bool) -> int:
    """Print them, as a table or as JSON; returns 1 if anything is in the way, else 0."""
    bad = sum(finding.level == "bad" for finding in findings)
    if as_json:
        print(json.dumps([asdict(finding) for finding in findings]))
        return 1 if bad else 0
    table = Table(title=title, title_justify="left")
    for column in ("", "what", "found, and what to do"):
        table.add_column(column, overflow="fold")
    for finding in findings:
        remedy = f"\n→ {finding.remedy}" if finding.remedy else ""
        table.add_row(finding.level, finding.what, finding.found + remedy)
    console = page()
    console.print(whole(table, console))
    notes = sum(finding.level == "note" for finding in findings)
    ways = f"{bad} of this is in the way" if bad else "nothing is in the way"
    console.print(f"{ways}{f'; {notes} to note' if notes else ''}")
    return 1 if bad else 0
