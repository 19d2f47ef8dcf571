"""Zenoh's own threads in this process: how many there are, and what it costs to call Python in one of them."""

import ctypes
import os
import threading
from collections.abc import Callable
from typing import TypeVar

T = TypeVar("T")
_ONE = "(app: (handover: tx), acc: (handover: tx), net: (handover: tx), rx: (handover: tx))"


def one_thread() -> None:
    """Let one thread do all of Zenoh's work: for who passes small messages on, each of which wakes nobody else then.

    Call it before the first session. What is called at an arrival must not put with congestion control BLOCK: it
    would wait for itself. Who has set ZENOH_RUNTIME keeps it.
    """
    os.environ.setdefault("ZENOH_RUNTIME", _ONE)


def resident(take: Callable[[T], object]) -> Callable[[T], object]:
    """The same callback for a thread that is not Python's own and calls it often.

    Of itself Python makes a state for such a thread at each call and throws it away after it, with a stack that the
    kernel maps and unmaps: that takes longer than all that a small message needs. Here each thread keeps its first one.
    """
    known = threading.local()

    def called(found: T) -> None:
        if not hasattr(known, "kept"):
            ctypes.pythonapi.PyGILState_Ensure()  # one more than will be released: the state stays to the end
            known.kept = True
        take(found)

    return called
