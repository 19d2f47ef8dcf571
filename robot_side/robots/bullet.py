"""PyBullet, imported and connected without its chatter on the user's terminal."""

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

GRAVITY = 9.81  # m/s^2


@contextmanager
def quiet() -> Iterator[None]:
    """What C code prints meanwhile goes nowhere; its buffers are emptied at both ends."""
    libc = ctypes.CDLL(None)
    _flush(libc)
    kept = {stream: os.dup(stream) for stream in (1, 2)}
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for stream in kept:
            os.dup2(nowhere, stream)
        yield
    finally:
        _flush(libc)
        for stream, copy in kept.items():
            os.dup2(copy, stream)
            os.close(copy)
        os.close(nowhere)


def _flush(libc: ctypes.CDLL) -> None:
    sys.stdout.flush()
    sys.stderr.flush()
    libc.fflush(None)


def connect() -> tuple[Any, int]:
    """The pybullet module, and a new world without graphics but with gravity along -z."""
    with quiet():
        import pybullet

        client = pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(0.0, 0.0, -GRAVITY, physicsClientId=client)
    return pybullet, client
