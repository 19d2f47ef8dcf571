"""One run of a campaign: what it takes (a Job) and what came of it (a Row). Both travel between processes."""

import hashlib
from typing import Any

import msgspec

from farhand.laboratory.simulation import simulate_run
from farhand.runs.run import Run
from farhand.runs.summary import RunSummary

DIGEST_DIGITS = 16


class Job(msgspec.Struct, frozen=True, kw_only=True):
    """Attributes:
    key: names the run within its campaign, e.g. `constant/paper/17`.
    labels: what was varied, by name; the first columns of the table.
    run: what to do.
    """

    key: str
    labels: dict[str, Any]
    run: Run


class Row(msgspec.Struct, frozen=True, kw_only=True):
    """What came of a job; SI units.

    Attributes:
        success: finished, and never nearer than d_min.
        finished: all targets reached within the time limit.
        safe: true clearance never below d_min.
        min_clearance: smallest true clearance (m); None without obstacles.
        duration: from the first motion command to the last target or the limit (s).
        digest: of every message that left or reached the operator, with its instant.
        error: what crashed, with its type; then nothing else has a meaning.
    """

    key: str
    labels: dict[str, Any]
    seed: int
    success: bool = False
    finished: bool = False
    safe: bool = False
    min_clearance: float | None = None
    min_arm_clearance: float | None = None
    duration: float | None = None
    path_length: float | None = None
    rtt_mean: float | None = None
    rtt_std: float | None = None
    interventions: int = 0
    infeasible: int = 0
    stops: int = 0
    refused: int = 0
    ticks: int = 0
    targets_reached: int = 0
    targets: int = 0
    digest: str = ""
    why: str = ""
    error: str = ""


FROM_SUMMARY = tuple(field for field in Row.__struct_fields__ if field in RunSummary.__struct_fields__)
"""The columns that are the summary's figures of the same name."""

UNITS = {
    "min_clearance": "m",
    "min_arm_clearance": "m",
    "duration": "s",
    "path_length": "m",
    "rtt_mean": "s",
    "rtt_std": "s",
}
"""Of the columns that have one."""


def run_job(job: Job) -> Row:
    """Run it; what raises becomes a row with `error`."""
    try:
        return _row(job)
    except Exception as error:  # a campaign of thousands must outlive one crash; the row names its seed
        return crashed(job, f"{type(error).__name__}: {error}")


def run_jobs(jobs: list[Job]) -> list[Row]:
    """A chunk of jobs, as sent to a worker."""
    return [run_job(job) for job in jobs]


def crashed(job: Job, error: str) -> Row:
    """The row of a job that has no result."""
    return Row(key=job.key, labels=job.labels, seed=job.run.seed, error=" ".join(error.split()))


def task_seed(*names: str | int) -> int:
    """A seed below 2^31 from names, the same everywhere."""
    digest = hashlib.sha256("/".join(map(str, names)).encode()).digest()
    return int.from_bytes(digest[:4], "big") >> 1


def _row(job: Job) -> Row:
    result = simulate_run(job.run, digest=True)
    summary = result.summary
    return Row(
        key=job.key,
        labels=job.labels,
        success=summary.safe and summary.finished,
        **{name: getattr(summary, name) for name in FROM_SUMMARY},
        digest=result.digest[:DIGEST_DIGITS],
    )
