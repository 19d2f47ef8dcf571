"""One run of a campaign: what it takes (a Job) and what came of it (a Row). Both travel between processes."""

import hashlib
from typing import Any

import msgspec

from farhand.common.seeds import stream
from farhand.laboratory.simulation import COMPUTING_TIME, simulate
from farhand.runs.scenario import Scenario

DIGEST_DIGITS = 16


class Job(msgspec.Struct, frozen=True, kw_only=True):
    """Attributes:
    key: names the run within its campaign, e.g. `constant/paper/17`.
    labels: what was varied, by name; the first columns of the table.
    scenario: what to do.
    uplink, downlink: SPECs.
    seed: of every random stream.
    time_limit: from the first motion command (s).
    computing_time: of a control tick (s); several values are a measured distribution, drawn from with
        replacement.
    """

    key: str
    labels: dict[str, Any]
    scenario: Scenario
    uplink: str
    downlink: str
    seed: int
    time_limit: float
    computing_time: tuple[float, ...] = (COMPUTING_TIME,)


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
    return Row(key=job.key, labels=job.labels, seed=job.seed, error=" ".join(error.split()))


def task_seed(*names: str | int) -> int:
    """A seed below 2^31 from names, the same everywhere."""
    digest = hashlib.sha256("/".join(map(str, names)).encode()).digest()
    return int.from_bytes(digest[:4], "big") >> 1


def _row(job: Job) -> Row:
    result = simulate(
        job.scenario,
        uplink=job.uplink,
        downlink=job.downlink,
        seed=job.seed,
        time_limit=job.time_limit,
        computing_time=_computing_time(job),
        digest=True,
    )
    summary = result.summary
    return Row(
        key=job.key,
        labels=job.labels,
        seed=job.seed,
        success=summary.safe and summary.finished,
        finished=summary.finished,
        safe=summary.safe,
        min_clearance=summary.min_clearance,
        min_arm_clearance=summary.min_arm_clearance,
        duration=summary.duration,
        path_length=summary.path_length,
        rtt_mean=summary.rtt_mean,
        rtt_std=summary.rtt_std,
        interventions=summary.interventions,
        infeasible=summary.infeasible,
        stops=summary.stops,
        refused=summary.refused,
        ticks=summary.ticks,
        targets_reached=summary.targets_reached,
        targets=summary.targets,
        digest=result.digest[:DIGEST_DIGITS],
        why=summary.why,
    )


def _computing_time(job: Job) -> Any:
    """A constant, or a function that draws."""
    samples = job.computing_time
    if len(samples) == 1:
        return samples[0]
    draw = stream(job.seed, "computing-time")
    return lambda: samples[int(draw.integers(len(samples)))]
