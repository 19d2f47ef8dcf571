"""Table I of the paper (arXiv 2403.18650) for the free-flying box, with many tasks instead of ten.

Every cell runs the same tasks over the same draws of the network: cells are compared task by task.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from farhand.common.errors import InputError
from farhand.laboratory.campaigns.jobs import Job, Row, task_seed
from farhand.laboratory.campaigns.statistics import Cell, clopper_pearson, summarise_cell
from farhand.laboratory.campaigns.store import source_digest
from farhand.laboratory.campaigns.tasks import BoxKind, make_task
from farhand.programs.wiring import versions
from farhand.runs.run import COMPUTING_TIME, Run, choose_network, read_choice

TIME_LIMIT = 300.0
"""Of a task (s): several times what a task takes, so that only a deadlock meets it."""

DELAYS = {
    "none": "none",
    "gaussian": "gaussian:50,20",
    "constant": "constant:200",
    "uniform": "uniform:50,200",
}
"""SPEC of each direction for each of the paper's delays."""

MARGINS = ("none", "paper", "adaptive")
SHOWS = ("laboratory/campaigns/figures.py", "laboratory/campaigns/table1_report.py")
"""Files of `farhand` that only show the rows."""

PAPER_TASKS = 10
PAPER = {
    ("none", "none"): 9,
    ("gaussian", "none"): 9,
    ("constant", "none"): 6,
    ("uniform", "none"): 7,
    ("none", "paper"): 10,
    ("gaussian", "paper"): 10,
    ("constant", "paper"): 10,
    ("uniform", "paper"): 10,
}
"""Successes of ten tasks in the paper's Table I, by (delay, margin)."""


@dataclass(frozen=True)
class Table1:
    """What to run.

    Attributes:
        tasks: for each cell.
        seed: of tasks and networks.
        delays, margins: names.
        robot: which model of the box.
        only: run this one task alone.
        computing_time: of a control tick (s); several values are drawn from.
        time_limit: of a task (s).
    """

    tasks: int = 200
    seed: int = 1
    delays: tuple[str, ...] = tuple(DELAYS)
    margins: tuple[str, ...] = MARGINS
    robot: BoxKind = "point"
    only: int | None = None
    computing_time: tuple[float, ...] = (COMPUTING_TIME,)
    time_limit: float = TIME_LIMIT

    @property
    def indices(self) -> Sequence[int]:
        """Of the tasks that run."""
        return range(self.tasks) if self.only is None else (self.only,)

    def about(self) -> dict[str, Any]:
        """What makes the rows, for the folder and for whoever wants to run a row again.

        The selection says which rows; it may grow later in the same folder.
        """
        return {
            "campaign": "table1",
            "seed": self.seed,
            "selection": {
                "tasks": list(self.indices) if self.only is not None else self.tasks,
                "delays": list(self.delays),
                "margins": list(self.margins),
            },
            "delays": DELAYS,
            "robot": self.robot,
            "computing_time": list(self.computing_time),
            "time_limit": self.time_limit,
            "versions": versions() | {"source": source_digest(*SHOWS)},
        }

    def jobs(self) -> list[Job]:
        """One a cell and task, task by task within a cell."""
        return [
            self.job(delay, margin, index)
            for delay in self.delays
            for margin in self.margins
            for index in self.indices
        ]

    def job(self, delay: str, margin: str, index: int) -> Job:
        """One run."""
        scenario = make_task(self.seed, index, self.robot, margin)
        return Job(
            key=f"{delay}/{margin}/{index}",
            labels={"delay": delay, "margin": margin, "task": index, "robot": self.robot},
            run=Run(
                scenario=scenario,
                network=choose_network(scenario, read_choice(DELAYS[delay])),
                seed=task_seed("table1", self.seed, index),
                time_limit=self.time_limit,
                computing_time=self.computing_time,
            ),
        )


@dataclass(frozen=True)
class PaperCell:
    """The paper's own figure and its interval of 95 %."""

    successes: int
    tasks: int
    rate: float
    low: float
    high: float


def paper_cell(delay: str, margin: str) -> PaperCell | None:
    """What the paper printed for a cell; None where it has none."""
    successes = PAPER.get((delay, margin))
    if successes is None:
        return None
    low, high = clopper_pearson(successes, PAPER_TASKS)
    return PaperCell(successes, PAPER_TASKS, successes / PAPER_TASKS, low, high)


def cells(rows: Sequence[Row]) -> dict[tuple[str, str], Cell]:
    """All cells, by (delay, margin); durations relative to the same delay without margin."""
    grouped: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        grouped.setdefault((row.labels["delay"], row.labels["margin"]), []).append(row)
    return {
        (delay, margin): summarise_cell(found, grouped.get((delay, "none")))
        for (delay, margin), found in grouped.items()
    }


def chosen(option: str, text: str, known: Sequence[str]) -> tuple[Any, ...]:
    """Names from a comma-separated option, in the given order, each once; raises InputError."""
    names = tuple(dict.fromkeys(name.strip() for name in text.split(",") if name.strip()))
    for name in names:
        if name not in known:
            raise InputError(f"{option} {name!r}: must be some of {', '.join(known)}")
    if not names:
        raise InputError(f"{option} {text!r}: names none of {', '.join(known)}")
    return names
