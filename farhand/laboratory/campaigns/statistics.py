"""Statistics of a table's cell: rates with exact intervals, medians, paired comparisons."""

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from farhand.laboratory.campaigns.jobs import Row

LEVEL = 0.95


def clopper_pearson(successes: int, trials: int, level: float = LEVEL) -> tuple[float, float]:
    """The exact interval of a success probability (Clopper and Pearson, Biometrika 26, 1934).

    It holds the true probability with at least `level`, whatever that is; (0, 1) without trials.
    """
    if not 0 <= successes <= trials:
        raise ValueError(f"{successes} of {trials}")
    if trials == 0:
        return 0.0, 1.0
    from scipy.stats import beta

    tail = (1.0 - level) / 2.0
    low = float(beta.ppf(tail, successes, trials - successes + 1)) if successes else 0.0
    high = float(beta.ppf(1.0 - tail, successes + 1, trials - successes)) if successes < trials else 1.0
    return low, high


@dataclass(frozen=True)
class Cell:
    """One cell of a table; SI units.

    Attributes:
        tasks: rows that did not crash.
        successes: finished and safe.
        finished, safe: the two parts of success.
        crashed: rows without a result.
        rate: successes over tasks; None without tasks.
        low, high: its Clopper-Pearson interval of 95 %.
        min_clearance, median_clearance: of the tasks' smallest clearances (m).
        median_duration: of the finished tasks (s).
        relative_duration: mean over the tasks finished in both of duration over that of the reference.
        interventions, infeasible: ticks, mean of a task.
        stops: latched stops, sum.
        rtt_mean: mean of a task's mean round trip (s).
    """

    tasks: int
    successes: int
    finished: int
    safe: int
    crashed: int
    rate: float | None
    low: float
    high: float
    min_clearance: float | None
    median_clearance: float | None
    median_duration: float | None
    relative_duration: float | None
    interventions: float
    infeasible: float
    stops: int
    rtt_mean: float | None


def summarise_cell(rows: Sequence[Row], reference: Sequence[Row] | None = None, by: str = "task") -> Cell:
    """The cell of some rows.

    Args:
        rows: of one cell.
        reference: rows of the same tasks to compare durations with.
        by: label that pairs a row with its reference.
    """
    good = [row for row in rows if not row.error]
    n = len(good)
    successes = sum(row.success for row in good)
    low, high = clopper_pearson(successes, n)
    clearances = [row.min_clearance for row in good if row.min_clearance is not None]
    durations = [row.duration for row in good if row.finished and row.duration is not None]
    trips = [row.rtt_mean for row in good if row.rtt_mean is not None]
    return Cell(
        tasks=n,
        successes=successes,
        finished=sum(row.finished for row in good),
        safe=sum(row.safe for row in good),
        crashed=len(rows) - n,
        rate=successes / n if n else None,
        low=low,
        high=high,
        min_clearance=min(clearances, default=None),
        median_clearance=statistics.median(clearances) if clearances else None,
        median_duration=statistics.median(durations) if durations else None,
        relative_duration=_relative(good, reference or [], by),
        interventions=statistics.fmean(row.interventions for row in good) if good else 0.0,
        infeasible=statistics.fmean(row.infeasible for row in good) if good else 0.0,
        stops=sum(row.stops for row in good),
        rtt_mean=statistics.fmean(trips) if trips else None,
    )


def _relative(rows: Sequence[Row], reference: Sequence[Row], by: str) -> float | None:
    known = {row.labels.get(by): row.duration for row in reference if row.finished and not row.error}
    ratios = [
        row.duration / base
        for row in rows
        if row.finished and row.duration is not None and (base := known.get(row.labels.get(by)))
    ]
    return statistics.fmean(ratios) if ratios else None
