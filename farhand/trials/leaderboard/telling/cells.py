"""Rows gathered into cells: rates with exact intervals, medians against the ideal."""

import statistics
from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import TypeVar

from farhand.laboratory.campaigns.statistics import clopper_pearson
from farhand.trials.leaderboard.plan.rows import Row

K = TypeVar("K", bound=Hashable)


@dataclass(frozen=True)
class Cell:
    """Some runs together; SI units. Intervals are Clopper and Pearson's, 95 %.

    Attributes:
        runs: all of them.
        crashed: of them, those without a result, as the method raised or its process died: neither safe nor done.
        successes, success_low, success_high: how many, and the interval of the rate.
        safe, safe_low, safe_high: likewise.
        finished: of them.
        violations: sum.
        evadable: of them, those that the robot could have evaded; sum.
        run_over: of the others, those in which the robot stood in a latched stop; sum.
        could_evade: runs with one that it could have evaded.
        depth: greatest (m).
        seconds: of violation, sum (s).
        least, median: clearance of the robot (m).
        least_tool: clearance of the sphere around the tool (m).
        time: median over the finished runs of the duration over the ideal operator's.
        path: likewise of the way.
        rtt: round trip, median of the runs' means (s).
        filtered, filtered_strength, guarded, guard_strength: means, see Row.
        stops: mean of a run.
        smoothness: median.
        worst: the run with the deepest violation; else the one with the least clearance.
    """

    runs: int
    crashed: int
    successes: int
    success_low: float
    success_high: float
    safe: int
    safe_low: float
    safe_high: float
    finished: int
    violations: int
    evadable: int
    run_over: int
    could_evade: int
    depth: float
    seconds: float
    least: float | None
    median: float | None
    least_tool: float | None
    time: float | None
    path: float | None
    rtt: float | None
    filtered: float
    filtered_strength: float
    guarded: float
    guard_strength: float | None
    stops: float
    smoothness: float | None
    worst: Row | None

    @property
    def success_rate(self) -> float | None:
        """Of the runs."""
        return self.successes / self.runs if self.runs else None

    @property
    def safe_rate(self) -> float | None:
        """Of the runs."""
        return self.safe / self.runs if self.runs else None


def cell_of(rows: Sequence[Row]) -> Cell:
    """The cell of some rows."""
    good = [row for row in rows if not row.error]
    done = [row for row in good if row.finished]
    successes, safe = sum(row.success for row in good), sum(row.safe for row in good)
    success_interval, safe_interval = clopper_pearson(successes, len(rows)), clopper_pearson(safe, len(rows))
    clearances = _known(row.min_clearance for row in good)
    tools = _known(row.min_tool_clearance for row in good)
    return Cell(
        runs=len(rows),
        crashed=len(rows) - len(good),
        successes=successes,
        success_low=success_interval[0],
        success_high=success_interval[1],
        safe=safe,
        safe_low=safe_interval[0],
        safe_high=safe_interval[1],
        finished=len(done),
        violations=sum(row.violations for row in good),
        evadable=sum(row.evadable for row in good),
        run_over=sum(row.run_over for row in good),
        could_evade=sum(row.evadable > 0 for row in good),
        depth=max((row.violation_depth for row in good), default=0.0),
        seconds=sum(row.violation_seconds for row in good),
        least=min(clearances, default=None),
        median=_median(clearances),
        least_tool=min(tools, default=None),
        time=_median(_ratios(done, "duration", "ideal_duration")),
        path=_median(_ratios(done, "path_length", "ideal_path")),
        rtt=_median(_known(row.rtt_mean for row in good)),
        filtered=_mean([row.filtered_share for row in good]) or 0.0,
        filtered_strength=_mean([row.filtered_strength for row in good]) or 0.0,
        guarded=_mean([row.guard_share for row in good]) or 0.0,
        guard_strength=_mean(_known(row.guard_strength for row in good)),
        stops=_mean([float(row.stops) for row in good]) or 0.0,
        smoothness=_median(_known(row.smoothness for row in good)),
        worst=min(good, key=_goodness, default=None),
    )


def cells_by(rows: Iterable[Row], key: Callable[[Row], K]) -> dict[K, Cell]:
    """A cell for each value of `key`, in the order in which they come."""
    grouped: dict[K, list[Row]] = {}
    for row in rows:
        grouped.setdefault(key(row), []).append(row)
    return {name: cell_of(found) for name, found in grouped.items()}


def told_cells(rows: Sequence[Row]) -> list[dict[str, object]]:
    """Each cell's names and figures, SI units; of the worst run its key."""
    names = ("operator", "method", "scene", "network")
    found = cells_by(rows, lambda row: tuple(getattr(row, name) for name in names))
    return [
        dict(zip(names, key, strict=True))
        | asdict(replace(cell, worst=None))
        | {"worst": cell.worst and cell.worst.key}
        for key, cell in found.items()
    ]


def _goodness(row: Row) -> tuple[float, bool, float]:
    """Small is bad: deep in, not finished, near."""
    clearance = row.min_clearance if row.min_clearance is not None else 0.0
    return (-row.violation_depth, row.success, clearance)


def _known(values: Iterable[float | None]) -> list[float]:
    return [value for value in values if value is not None]


def _ratios(rows: Sequence[Row], over: str, under: str) -> list[float]:
    pairs = [(getattr(row, over), getattr(row, under)) for row in rows]
    return [a / b for a, b in pairs if a is not None and b]


def _median(values: Sequence[float]) -> float | None:
    return statistics.median(values) if values else None


def _mean(values: Sequence[float]) -> float | None:
    return statistics.fmean(values) if values else None
