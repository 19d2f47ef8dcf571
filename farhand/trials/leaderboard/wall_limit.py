"""What takes too long of real time is given up, where the system can tell."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

AGAIN = 1.0
"""What was caught on the way is raised again after so long (s)."""


@contextmanager
def wall_limit(seconds: float) -> Iterator[None]:
    """Raise TimeoutError within, once so long (s) has passed; no limit outside a process's main thread.

    Whoever catches it within, as programs do with what a kind raises, gets it again, and it is raised in the end.
    """
    if threading.current_thread() is not threading.main_thread() or not hasattr(signal, "setitimer"):
        yield
        return
    told = f"took more than {seconds:g} s of real time"
    is_late = False

    def late(signum: int, frame: FrameType | None) -> None:
        nonlocal is_late
        is_late = True
        raise TimeoutError(told)

    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, seconds, AGAIN)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    if is_late:
        raise TimeoutError(told)
