"""The rows of a trial's jobs, in as many processes as asked for."""

from concurrent.futures import as_completed

from farhand.laboratory.campaigns.jobs import Job, Row, run_job
from farhand.laboratory.campaigns.pools import LocalPool


def rows_of(jobs: list[Job], workers: int) -> list[Row]:
    """Run them, in the order in which they end; `workers` 0: in this process alone, in their own order."""
    if workers == 0:
        return [run_job(job) for job in jobs]
    with LocalPool(workers).open() as executor:
        return [done.result() for done in as_completed([executor.submit(run_job, job) for job in jobs])]
