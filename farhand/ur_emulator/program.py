"""A URScript program that runs: its threads take turns, each until it waits, once a controller cycle."""

from collections.abc import Callable, Generator, Mapping
from typing import Any

from farhand.ur_emulator.urscript import Translation

STEPS_A_CYCLE = 20_000
"""Turns of loops after which a thread that waits for nothing has used up its share of a cycle."""
MOST_THREADS = 32


class Thread:
    """A thread of a program: what is left of it, and whether it has ended."""

    def __init__(self, steps: Generator[None, None, Any]) -> None:
        self.steps = steps
        self.ended = False


class Program:
    """One program, from its upload to its end. What goes wrong in it ends it and is in `error`.

    Args:
        translation: what to run.
        functions: what it may call, by name; those that wait are generators.

    Attributes:
        running: whether it has not ended.
        error: what ended it; empty: nothing did, or it came to its end.
    """

    def __init__(self, translation: Translation, functions: Mapping[str, Callable[..., Any]]) -> None:
        self.running, self.error = True, ""
        self._critical: Thread | None = None
        self._current: Thread | None = None
        self._spent = 0
        self._halted = False
        space: dict[str, Any] = {"__builtins__": {"bool": bool}}
        space.update({f"b_{name}": function for name, function in functions.items()})
        own = (
            ("run", self._run), ("kill", self._kill), ("join", self._join), ("halt", self._halt),
            ("enter_critical", self._enter), ("exit_critical", self._leave), ("spent", self._is_spent),
            ("copied", _copied),
        )  # fmt: skip
        space.update({f"b_{name}": function for name, function in own})
        exec(
            translation.code, space
        )  # names are prefixed and calls are of `functions` alone: see urscript.py
        self._main = Thread(space[f"f_{translation.main}"]())
        self._threads = [self._main]

    def cycle(self) -> None:
        """Let every thread run until it waits."""
        for thread in list(self._threads):
            if self._critical not in (None, thread) or thread.ended:
                continue
            self._current, self._spent = thread, 0
            self._resume(thread)
            if not self.running:
                return
        self._threads = [thread for thread in self._threads if not thread.ended]

    def end(self) -> None:
        """Stop all threads; harmless when it has ended."""
        self.running = False
        for thread in self._threads:
            self._kill(thread)

    def _resume(self, thread: Thread) -> None:
        try:
            next(thread.steps)
        except StopIteration:
            thread.ended = True
        except Exception as error:  # whatever a program does: its own fault ends it, not the controller
            self.error = f"{type(error).__name__}: {error}"
            self._halted = True
        if thread.ended and self._critical is thread:
            self._critical = None
        if self._halted or (thread.ended and thread is self._main):
            self.end()

    def _run(self, function: Callable[[], Generator[None, None, Any]]) -> Thread:
        if len(self._threads) >= MOST_THREADS:
            raise RuntimeError("too many threads")
        thread = Thread(function())
        self._threads.append(thread)
        return thread

    def _kill(self, thread: Any) -> None:
        if not isinstance(thread, Thread) or thread.ended:
            return
        thread.ended = True
        if self._critical is thread:
            self._critical = None
        if thread is not self._current:
            thread.steps.close()

    def _join(self, thread: Any) -> Generator[None, None, None]:
        while isinstance(thread, Thread) and not thread.ended:
            yield

    def _halt(self) -> Generator[None, None, None]:
        self._halted = True
        yield

    def _enter(self) -> None:
        self._critical = self._current

    def _leave(self) -> None:
        self._critical = None

    def _is_spent(self) -> bool:
        self._spent += 1
        return self._spent % STEPS_A_CYCLE == 0


def _copied(value: Any) -> Any:
    return type(value)(value) if isinstance(value, list) else value
