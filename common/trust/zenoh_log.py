"""Takes Zenoh's log, which goes to standard output, out of it and to `Refusals`.

All that this process writes to file descriptor 1 passes through a pipe; what is not Zenoh's goes on to where
it was going. Python's own `print` is not concerned: `sys.stdout` is given the old descriptor.
"""

import fcntl
import os
import select
import sys
import threading
from collections.abc import Callable

import zenoh

from farhand.common.timing.clock import SystemClock
from farhand.common.trust.refusals import LEVELS, Refusals

PIPE_SIZE = 1 << 20
CHUNK = 1 << 16
PAUSE = 0.05
"""Between looks at the log (s): the threads that write it must not wake one that reads it each time."""
QUIET = 1.0
"""After this long without a word, counts are still told (s)."""

_taken = False


def tell_refusals(say: Callable[[str], None]) -> None:
    """From now on say whom Zenoh refuses; does nothing where the user has asked for Zenoh's log (RUST_LOG)."""
    global _taken
    if _taken or os.environ.get("RUST_LOG"):
        zenoh.init_log_from_env_or("error")
        return
    _taken = True
    sys.stdout.flush()
    onward = os.dup(1)
    reading, writing = os.pipe()
    try:
        fcntl.fcntl(writing, fcntl.F_SETPIPE_SZ, PIPE_SIZE)
    except OSError:
        pass  # a smaller pipe only means more looks at it
    os.dup2(writing, 1)
    os.close(writing)
    encoding, errors = sys.stdout.encoding or "utf-8", getattr(sys.stdout, "errors", None) or "strict"
    sys.stdout = open(onward, "w", encoding=encoding, errors=errors, buffering=1, closefd=False)  # noqa: SIM115
    colour = os.environ.get("NO_COLOR")
    os.environ["NO_COLOR"] = "1"  # asked for in Zenoh's log only
    zenoh.init_log_from_env_or(LEVELS)
    if colour is None:
        del os.environ["NO_COLOR"]
    else:
        os.environ["NO_COLOR"] = colour
    refusals, clock, pause = Refusals(say), SystemClock(), threading.Event()

    def read() -> None:
        while True:
            if select.select([reading], [], [], QUIET)[0]:
                chunk = os.read(reading, CHUNK)
                others = refusals.feed(chunk, clock.now_ns())
                if others:
                    os.write(onward, others)
                if len(chunk) < CHUNK:
                    pause.wait(PAUSE)
            refusals.tick(clock.now_ns())

    threading.Thread(target=read, name="zenoh-log", daemon=True).start()
