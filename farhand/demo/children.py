"""Child processes that never outlive their parent."""

import os
import signal
import subprocess
import sys
from collections.abc import Collection, Sequence
from contextlib import suppress
from pathlib import Path

from farhand.common.process.signals import PARENT_VARIABLE
from farhand.common.timing.clock import SystemClock, to_ns

PATIENCE = 1.5
LONG_PATIENCE = 6.0
"""For one that still has something to write, on a machine that is slow."""


class Children:
    """Programs of Farhand run as child processes, each with a log file.

    Args:
        folder: where the logs go.
        clock: for the patience at the end.

    Attributes:
        running: all that were started, by name.
        killed: those that did not end when asked, with how long they had (s).
    """

    def __init__(self, folder: Path, clock: SystemClock) -> None:
        self._folder, self._clock = folder, clock
        self.running: dict[str, subprocess.Popen[bytes]] = {}
        self.killed: dict[str, float] = {}

    def start(self, name: str, arguments: Sequence[str]) -> None:
        """Start `farhand ARGUMENTS`; the kernel ends it should this process die."""
        environment = os.environ | {PARENT_VARIABLE: str(os.getpid()), "PYTHONUNBUFFERED": "1"}
        with (self._folder / f"{name}.log").open("wb") as log:
            self.running[name] = subprocess.Popen(
                [sys.executable, "-m", "farhand", *arguments],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                env=environment,
            )

    def ended(self, *, beside: Collection[str] = ()) -> dict[str, int]:
        """Exit codes of those that have ended, but for some that others do without."""
        found = {name: p.returncode for name, p in self.running.items() if p.poll() is not None}
        return {name: code for name, code in found.items() if name not in beside}

    def wait_for(self, name: str) -> None:
        """Give one that ends by itself the time for it (1.5 s)."""
        if name in self.running:
            self._wait([name], PATIENCE)

    def ask(self, *, beside: Collection[str] = ()) -> None:
        """Ask all but some to end."""
        for name, process in self.running.items():
            if name not in beside and process.poll() is None:
                process.send_signal(signal.SIGTERM)

    def stop(self, *, patient: Collection[str] = ()) -> None:
        """End all of them: asked first, made to after 1.5 s, or after 6 s where one still has something to write."""
        self.ask()
        others = [name for name in self.running if name not in patient]
        for names, patience in ((others, PATIENCE), ([*patient], LONG_PATIENCE)):
            late = self._wait([name for name in names if name in self.running], patience)
            for name in late:
                self.killed[name] = patience
                self.running[name].kill()
            self._wait(late, PATIENCE)

    def _wait(self, names: Collection[str], timeout: float) -> list[str]:
        """Those that have not ended within `timeout` s."""
        deadline_ns = self._clock.now_ns() + to_ns(timeout)
        for name in names:
            with suppress(subprocess.TimeoutExpired):
                self.running[name].wait(max(0.0, (deadline_ns - self._clock.now_ns()) * 1e-9))
        return [name for name in names if self.running[name].poll() is None]

    def has_said(self, name: str, words: str) -> bool:
        """Whether a line of a child's log begins with these words, behind the child's name."""
        return any(line.startswith(f"{name}: {words}") for line in self._lines(name))

    def last_words(self, name: str) -> str:
        """The last line of a child's log."""
        lines = self._lines(name)
        return lines[-1] if lines else ""

    def _lines(self, name: str) -> list[str]:
        try:
            return (self._folder / f"{name}.log").read_text(errors="replace").strip().splitlines()
        except OSError:
            return []
