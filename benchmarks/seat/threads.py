"""Threads beside what is measured, and the load while it is."""

import os
import threading
from collections.abc import Callable
from contextlib import ExitStack

from websockets.exceptions import ConnectionClosed

from tests.operator_side.console.caller import Caller


def listen(caller: Caller, ended: threading.Event) -> None:
    try:
        while not ended.is_set():
            caller.hear("frame")
    except ConnectionClosed:
        pass  # at the end


def started(closing: ExitStack, ended: threading.Event, what: Callable[..., None], *args: object) -> None:
    def quiet() -> None:
        try:
            what(*args)
        except Exception:
            if not ended.is_set():
                raise

    thread = threading.Thread(target=quiet, daemon=True)
    thread.start()
    closing.callback(thread.join, 3.0)
    closing.callback(ended.set)


def load() -> float:
    return os.getloadavg()[0]
