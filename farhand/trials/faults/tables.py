"""The two tables of `make faults`, for a terminal or for a document."""

from collections.abc import Iterable, Mapping, Sequence

from rich.console import Console
from rich.table import Table

from farhand.trials.faults.attacks import Attacked
from farhand.trials.faults.judgement import Outcome

FAULT_HEADINGS = (
    "fault",
    "stands after (s)",
    "acknowledged (s)",
    "drives (s)",
    "oldest basis (s)",
    "sent",
    "lost",
    "refused",
    "states lost",
    "safe",
)
ARM_STANDS = "arm stands after (s)"
"""Beside a fault, where there is an arm whose controller knows."""
ATTACK_HEADINGS = (
    "attacker",
    "let in",
    "sent",
    "states read",
    "said of it",
    "refused by the robot",
    "lawful operator",
    "safe",
)


def fault_headings(kind: str) -> tuple[str, ...]:
    """Of the table of faults with a robot of that kind."""
    name, stands, *others = FAULT_HEADINGS
    return (name, stands, *((ARM_STANDS,) if kind == "ur" else ()), *others)


def fault_row(name: str, outcome: Outcome | str, kind: str) -> tuple[str, ...]:
    """One fault; a text says why it was left out."""
    if isinstance(outcome, str):
        return (name, *("-",) * (len(fault_headings(kind)) - 2), f"left out: {outcome}")
    arm = outcome.arm_stood
    return (
        name,
        seconds(outcome.standing),
        *(("-" if arm is None else f"{arm:.3f}",) if kind == "ur" else ()),
        seconds(outcome.acknowledged),
        seconds(outcome.again),
        f"{outcome.oldest:.2f}",
        str(outcome.sent),
        str(outcome.lost),
        counts(outcome.refused),
        str(outcome.states_lost),
        verdict(outcome.unsafe),
    )


def attack_row(attacked: Attacked) -> tuple[str, ...]:
    """One attack."""
    outcome = attacked.outcome
    kept = "drove on" if outcome.standing is None else f"stood after {outcome.standing:.2f} s, drove again"
    ports = f" to {attacked.found['ports']} ports" if "ports" in attacked.found else ""
    return (
        attacked.name,
        "yes" if attacked.found["connected"] else "no",
        f"{number(attacked.found['sent'])}{ports}",
        number(attacked.found["read"]),
        attacked.line,
        counts(outcome.refused),
        kept,
        verdict(attacked.unsafe),
    )


def number(value: int | None) -> str:
    """A count; a dash for what was not counted."""
    return "-" if value is None else str(value)


def seconds(value: float | None) -> str:
    """A duration for people; a dash for None."""
    return "-" if value is None else f"{value:.2f}"


def counts(refused: Mapping[str, int]) -> str:
    """Reasons and how often."""
    return ", ".join(f"{why} {count}" for why, count in refused.items()) or "0"


def verdict(unsafe: Sequence[str]) -> str:
    """Yes, or what was wrong."""
    return "yes" if not unsafe else f"NO: {'; '.join(unsafe)}"


def markdown(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table for docs/faults.md."""
    lines = ["| " + " | ".join(headings) + " |", "|" + "---|" * len(headings)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def show(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """A table on the terminal, as wide as that is, and at least 150 columns."""
    console = Console(markup=False)
    table = Table(*headings)
    for row in rows:
        table.add_row(*row)
    Console(width=max(150, console.width), markup=False).print(table)
