"""The scheduling rights of a thread."""

import ctypes
import os

_PR_SET_TIMERSLACK = 29


def request_realtime(priority: int = 20) -> bool:
    """Ask for SCHED_FIFO and 1 us timer slack for the calling thread; False where that is not allowed."""
    try:
        ctypes.CDLL(None).prctl(_PR_SET_TIMERSLACK, 1000, 0, 0, 0)
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except (OSError, AttributeError):
        return False
    return True
