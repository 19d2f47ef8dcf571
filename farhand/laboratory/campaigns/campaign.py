"""Runs jobs in a pool: in chunks, rows kept as they come, a stopped campaign goes on, a crash costs one row."""

from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from farhand.common.errors import InputError
from farhand.laboratory.campaigns.jobs import Job, Row, crashed, run_jobs
from farhand.laboratory.campaigns.pools import Pool
from farhand.laboratory.campaigns.store import Keyed, R, Store

CHUNK = 8
AHEAD = 2
"""Chunks handed in for each one that runs."""

J = TypeVar("J", bound=Keyed)


@dataclass(frozen=True)
class Work(Generic[J, R]):
    """Attributes:
    run: does a chunk of jobs in a worker; importable by name there, and never raises.
    crashed: the row of a job whose process died, and why.
    """

    run: Callable[[list[J]], list[R]]
    crashed: Callable[[J, str], R]


class PoolLostError(InputError):
    """The pool went away for good; the finished rows are kept."""


def run_campaign(
    jobs: Sequence[J],
    store: Store[R],
    pool: Pool,
    progress: Callable[[R], None] | None = None,
    chunk: int = CHUNK,
    work: Work[J, R] | None = None,
) -> list[R]:
    """All rows in the order of the jobs; only those that the store lacks are run.

    Args:
        jobs: with distinct keys.
        store: where finished rows are and go.
        pool: where to run.
        progress: called with every new row.
        chunk: jobs sent to a worker at once.
        work: what is done with them; None: they are runs of the laboratory.
    """
    doing: Any = work or Work[Job, Row](run_jobs, crashed)
    missing = store.missing(jobs)
    chunks = deque([missing[i : i + chunk] for i in range(0, len(missing), chunk)])

    def keep(rows: list[R]) -> None:
        for row in rows:
            if store.add(row) and progress is not None:
                progress(row)

    suspects: list[J] = []
    while chunks:
        with pool.open() as executor:
            broken = _drain(executor, chunks, pool.width * AHEAD, keep, doing)
        for each in broken:
            suspects.extend(each)
    while suspects:
        suspects = _run_alone(suspects, pool, keep, doing)
    return store.ordered(jobs)


def _drain(
    executor: Executor,
    chunks: deque[list[J]],
    limit: int,
    keep: Callable[[list[R]], None],
    work: Work[J, R],
) -> list[list[J]]:
    """Run chunks until none is left or the pool breaks; returns those whose worker died."""
    running: dict[Future[list[R]], list[J]] = {}
    lost: list[list[J]] = []
    try:
        while chunks or running:
            while chunks and len(running) < limit:
                running[executor.submit(work.run, chunks[0])] = chunks[0]
                chunks.popleft()
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                error = future.exception()
                if isinstance(error, BrokenProcessPool | OSError):
                    raise error
                if error is None:
                    keep(future.result())
                else:  # Dask's KilledWorker, say: the pool lives on
                    lost.append(running[future])
                del running[future]
    except BrokenProcessPool:
        return lost + _rescued(running, keep)
    except (OSError, CancelledError, TimeoutError) as error:
        _rescued(running, keep)
        raise PoolLostError(
            f"the pool is gone ({type(error).__name__}: {error}); finished rows are kept, run it again to go on"
        ) from None
    return lost


def _rescued(running: dict[Future[list[R]], list[J]], keep: Callable[[list[R]], None]) -> list[list[J]]:
    """What had finished before the break is kept; the rest is returned."""
    lost = []
    for future, jobs in running.items():
        if future.done() and not future.cancelled() and future.exception() is None:
            keep(future.result())
        else:
            lost.append(jobs)
    return lost


def _run_alone(jobs: list[J], pool: Pool, keep: Callable[[list[R]], None], work: Work[J, R]) -> list[J]:
    """Jobs that were in a process when one died: one at a time, so that it is plain which one did it.

    Returns those that are left when one has taken its process with it again.
    """
    with pool.open(1) as executor:
        for number, job in enumerate(jobs, 1):
            future = executor.submit(work.run, [job])
            error = future.exception()
            if error is None:
                keep(future.result())
                continue
            if isinstance(error, OSError):
                raise PoolLostError(
                    f"the pool is gone ({error}); finished rows are kept, run it again to go on"
                )
            keep([work.crashed(job, f"the process that ran it died ({type(error).__name__})")])
            return jobs[number:]
    return []
