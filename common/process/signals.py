"""What every program of Farhand does around its loop: signals, its parent's death, the wait for a peer."""

import ctypes
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from types import FrameType

from farhand.common.process.stop_event import StopEvent

PARENT_VARIABLE = "FARHAND_PARENT"
_PR_SET_PDEATHSIG = 1
SAY_AFTER = 5.0
PARENT_CHECK = 0.25
GRACE = 1.5


def say(program: str, line: str) -> None:
    """One line for people, on stderr; where nobody can read it any more, it is lost."""
    try:
        print(f"{program}: {line}", file=sys.stderr, flush=True)
    except (OSError, ValueError):
        pass


def interrupt_on_signals() -> None:
    """Have SIGTERM and SIGHUP end what runs as Ctrl-C does, by KeyboardInterrupt, until a program says otherwise.

    SIGHUP is left alone where it is ignored, as by nohup.
    """

    def interrupt(_signal: int, _frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if number != signal.SIGHUP or signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, interrupt)


def stop_event_on_signals() -> threading.Event:
    """An event that SIGINT, SIGTERM and SIGHUP set; to be called from the main thread, which may wait for it.

    A program that was started with SIGHUP ignored, as by nohup, goes on ignoring it.
    """
    event = StopEvent()

    def stop(_signal: int, _frame: FrameType | None) -> None:
        event.set()

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if number != signal.SIGHUP or signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, stop)
    return event


@contextmanager
def stopped_by_signals() -> Iterator[threading.Event]:
    """`stop_event_on_signals` for a while: afterwards the signals mean what they meant before."""
    kept = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    try:
        yield stop_event_on_signals()
    finally:
        for number, handler in kept.items():
            signal.signal(number, handler)


def die_with_parent() -> None:
    """If a parent named itself in the environment, be terminated by the kernel when it dies."""
    parent = os.environ.get(PARENT_VARIABLE, "")
    if not parent.isdigit():
        return
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM, 0, 0, 0)
    if os.getppid() != int(parent):  # it died before the call
        raise SystemExit(1)
    threading.Thread(target=_outlive_briefly, args=(int(parent),), name="parent-watch", daemon=True).start()


def _outlive_briefly(parent: int) -> None:
    """End this process for good 1.5 s after its parent's death, whatever it may hang in by then."""
    pause = threading.Event()
    while os.getppid() == parent:
        pause.wait(PARENT_CHECK)
    pause.wait(GRACE)
    os._exit(1)


class PeerWatch:
    """Says when nobody answers for 5 s, and when somebody does after that; Zenoh goes on trying.

    Args:
        program: name of the program, for the line.
        where: the endpoints, for the line.
        connected: whether a peer is there.
        stop_event: ends the watch.
        heard: whether anything has come yet; None: not looked at.
        unheard: what to say when somebody is connected but nothing has come for 5 s.
        troubles: lines about what went wrong, by kind of trouble; each kind is said once.

    Attributes:
        alone: whether nobody was connected when it looked last, a second ago at most.
    """

    def __init__(
        self,
        program: str,
        where: str,
        connected: Callable[[], bool],
        stop_event: threading.Event,
        heard: Callable[[], bool] | None = None,
        unheard: str = "",
        troubles: Callable[[], Mapping[str, str]] | None = None,
    ) -> None:
        self._troubles = troubles
        self._heard, self._unheard = heard, unheard
        self._program, self._where, self._connected, self._stop = program, where, connected, stop_event
        self.alone = False
        self._thread = threading.Thread(target=self._watch, name="peer-watch", daemon=True)
        self._thread.start()

    def _watch(self) -> None:
        waited, said, silent = 0.0, False, 0.0
        told: set[str] = set()
        while not self._stop.wait(1.0):
            for kind, line in self._troubles().items() if self._troubles is not None else ():
                if kind not in told:
                    told.add(kind)
                    say(self._program, line)
            self.alone = not self._connected()
            if not self.alone:
                if said:
                    say(self._program, f"{self._where}: connected")
                waited, said = 0.0, False
                if self._heard is not None and self._heard():
                    self._heard = None
                elif self._heard is not None:
                    silent += 1.0
                    if silent == SAY_AFTER:
                        say(self._program, f"{self._where}: {self._unheard}")
                continue
            waited += 1.0
            if waited >= SAY_AFTER and not said:
                said = True
                say(self._program, f"{self._where}: nobody answers for {waited:.0f} s; still trying")
