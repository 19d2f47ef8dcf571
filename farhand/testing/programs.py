"""The real programs as child processes: what they say, how they end, and that nothing of them stays."""

import os
import queue
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from types import TracebackType
from typing import IO

from farhand.common.timing.clock import SystemClock, to_ns, to_seconds

PATIENCE = 60.0
"""How long tests wait for what will come (s): a loaded machine is slow, and only a failure takes so long."""
ENDS_WITHIN = 6.0
"""How long an interrupted program may take (s): 2 s are promised, and a loaded machine may add to it."""


class Program:
    """`python -m farhand WORDS...` and what it says on stderr, line by line.

    Args:
        words: the command line; paths and numbers are turned into text.
        module: run in place of `farhand`.
        log: file that gets every line as well, for somebody who looks at a failure.
        environment: variables in addition to this process's own.

    Attributes:
        process: the child.
        said: lines read so far.
        output: what it wrote to stdout; complete once it has ended.
    """

    def __init__(
        self,
        *words: object,
        module: str = "farhand",
        log: Path | None = None,
        environment: Mapping[str, str] | None = None,
    ) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", module, *map(str, words)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, **(environment or {})},
        )
        self.said: list[str] = []
        self.output = ""
        self._clock = SystemClock()
        self._lines: queue.Queue[str | None] = queue.Queue()
        self._log = log
        assert self.process.stderr is not None
        assert self.process.stdout is not None
        self._readers = [
            threading.Thread(target=self._read, args=(self.process.stderr,), daemon=True),
            threading.Thread(target=self._collect, args=(self.process.stdout,), daemon=True),
        ]
        for reader in self._readers:
            reader.start()

    @property
    def pid(self) -> int:
        """The child's process id."""
        return self.process.pid

    @property
    def alive(self) -> bool:
        """Whether it still runs."""
        return self.process.poll() is None

    def wait_for(self, text: str, patience: float = PATIENCE) -> str:
        """The next line with this text in it; AssertionError if it ends or `patience` (s) is over before."""
        return self.wait_for_line(lambda line: text in line, patience, repr(text))

    def wait_for_line(
        self, holds: Callable[[str], bool], patience: float = PATIENCE, what: str = "such a line"
    ) -> str:
        """The next line of which it holds; the failure calls it `what`."""
        deadline_ns = self._clock.now_ns() + to_ns(patience)
        while True:
            left = to_seconds(deadline_ns - self._clock.now_ns())
            try:
                line = self._lines.get(timeout=max(0.0, left))
            except queue.Empty:
                raise AssertionError(f"{what} did not come within {patience:g} s: {self.said}") from None
            if line is None:
                self._lines.put(None)
                raise AssertionError(f"it ended before {what}: {self.said}")
            self.said.append(line)
            if holds(line):
                return line

    def wait(self, patience: float = PATIENCE) -> int:
        """Its exit code, once it has ended and all that it said is read; AssertionError if it runs on."""
        try:
            code = self.process.wait(patience)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"it still runs after {patience:g} s: {self.said}") from None
        for reader in self._readers:
            reader.join(PATIENCE)
        while (line := self._lines.get(timeout=PATIENCE)) is not None:
            self.said.append(line)
        self._lines.put(None)
        return code

    def signal(self, number: int) -> None:
        """Send it a signal."""
        self.process.send_signal(number)

    def interrupt(self, patience: float = ENDS_WITHIN) -> int:
        """What Ctrl-C does; its exit code."""
        self.signal(signal.SIGINT)
        return self.wait(patience)

    def close(self) -> None:
        """End it, if need be by force; harmless when it has ended."""
        if self.alive:
            self.process.kill()
        self.wait()

    def __enter__(self) -> "Program":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _read(self, stream: IO[str]) -> None:
        with stream:
            for line in stream:
                self._lines.put(line.strip())
                if self._log is not None:
                    with self._log.open("a", encoding="utf-8") as log:
                        log.write(line)
        self._lines.put(None)

    def _collect(self, stream: IO[str]) -> None:
        with stream:
            self.output = stream.read()


class Programs:
    """Programs that end together: with the `with` block, whatever went wrong, the last started first.

    Args:
        logs: folder that gets a log of each, `1-robot.log` and so on; None: none.
    """

    def __init__(self, logs: Path | None = None) -> None:
        self.running: list[Program] = []
        self._logs = logs

    def start(self, *words: object, environment: Mapping[str, str] | None = None) -> Program:
        """Start `farhand WORDS...`."""
        log = None
        if self._logs is not None:
            log = self._logs / f"{len(self.running) + 1}-{words[0] if words else 'farhand'}.log"
        self.running.append(Program(*words, log=log, environment=environment))
        return self.running[-1]

    def close(self) -> None:
        """End all that still run."""
        for program in reversed(self.running):
            program.close()

    def __enter__(self) -> "Programs":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def ask_farhand(*words: object, patience: float = PATIENCE) -> tuple[int, str]:
    """Exit code, and what was printed (stdout, then stderr), of a command that ends by itself."""
    with Program(*words) as program:
        code = program.wait(patience)
        return code, (program.output + "\n".join(program.said)).strip()
