"""Where jobs run: processes of this machine, or a Dask cluster, both as `concurrent.futures.Executor`."""

import contextlib
import multiprocessing
import os
import signal
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from multiprocessing import resource_tracker
from typing import Any

from farhand.common.errors import InputError
from farhand.common.process.signals import PARENT_VARIABLE, die_with_parent

ANSWER_TIMEOUT = 10.0
"""For a scheduler to answer (s)."""
RETRIES = 5
"""A chunk whose worker died is run again on another one this often."""


class Pool:
    """Makes executors, again and again where one broke."""

    def __init__(self, workers: int) -> None:
        self.workers = workers

    @property
    def width(self) -> int:
        """How many chunks run at the same time."""
        return self.workers

    @contextlib.contextmanager
    def open(self, workers: int = 0) -> Iterator[Executor]:
        """An executor, closed at the end without waiting for what has not begun; 0 takes the pool's width."""
        raise NotImplementedError


class LocalPool(Pool):
    """Fresh processes that import once.

    Args:
        workers: how many; 0 takes one for each processor that this process may use.
    """

    def __init__(self, workers: int = 0) -> None:
        super().__init__(workers or len(os.sched_getaffinity(0)))

    @contextlib.contextmanager
    def open(self, workers: int = 0) -> Iterator[Executor]:
        """See Pool."""
        context = multiprocessing.get_context("spawn")
        count = workers or self.workers
        _shield_the_tracker()
        executor = ProcessPoolExecutor(
            count, mp_context=context, initializer=_start_worker, initargs=(os.getpid(),)
        )
        try:
            yield executor
        except BaseException:
            # Ctrl-C, say: what runs would go on for a while, and its rows are wanted by nobody.
            for process in list((executor._processes or {}).values()):
                process.terminate()
            raise
        finally:
            executor.shutdown(wait=True, cancel_futures=True)


class DaskPool(Pool):
    """A Dask cluster: Farhand must be installed where its workers run.

    Args:
        address: of the scheduler, e.g. tcp://10.0.0.5:8786.
        option: that named it, for errors.
    """

    def __init__(self, address: str, option: str = "--scheduler") -> None:
        super().__init__(0)
        self._address, self._option = address, option

    @property
    def width(self) -> int:
        """See Pool; workers may come and go, so that there is always something to do for a few dozen."""
        return 32

    @contextlib.contextmanager
    def open(self, workers: int = 0) -> Iterator[Executor]:
        """See Pool; raises InputError when the scheduler does not answer."""
        try:
            import distributed as untyped
        except ImportError:
            raise InputError(
                f"{self._option}: the `distributed` package is missing; pip install 'farhand[dask]'"
            ) from None
        try:
            distributed: Any = untyped
            client = distributed.Client(self._address, timeout=ANSWER_TIMEOUT, set_as_default=False)
        except (OSError, ValueError, ImportError, TimeoutError) as error:
            why = str(error).splitlines()[0] if str(error) else type(error).__name__
            raise InputError(f"{self._option} {self._address}: no Dask scheduler answers: {why}") from None
        executor = client.get_executor(retries=RETRIES, pure=False)
        try:
            yield executor
        finally:
            with contextlib.suppress(Exception):  # the cluster may be gone; the rows are on disk already
                executor.shutdown(wait=False)
            client.close()


def _shield_the_tracker() -> None:
    """Have multiprocessing's resource tracker outlive a SIGHUP to the process group, as it outlives Ctrl-C.

    It inherits what is blocked here. One that dies is started anew, knows of nothing, and fills the terminal with that.
    """
    blocked = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGHUP})
    try:
        resource_tracker.ensure_running()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, blocked)


def _start_worker(parent: int) -> None:
    """In a new process: the parent alone answers Ctrl-C, its death ends this one; import and compile once."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.environ[PARENT_VARIABLE] = str(parent)
    die_with_parent()
    from farhand.operator_side.control.registry import make_controller
    from farhand.operator_side.control.settings import ControllerSettings
    from farhand.operator_side.prepare import prepare

    prepare(make_controller(ControllerSettings()))
