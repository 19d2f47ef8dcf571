"""PyBullet, imported and connected without its chatter on stdout, which belongs to the user's program."""

import ctypes
import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from typing import Any

GRAVITY = 9.81  # m/s^2


@contextmanager
def silent_stdout() -> Iterator[None]:
    """What is printed meanwhile, by Python or by C, goes nowhere; C's buffers are emptied at both ends."""
    libc = ctypes.CDLL(None)
    sys.stdout.flush()
    libc.fflush(None)
    kept = os.dup(1)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        with redirect_stdout(io.StringIO()):
            yield
    finally:
        libc.fflush(None)
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def connect() -> tuple[Any, int]:
    """The pybullet module, and a new world without graphics but with gravity along -z."""
    with silent_stdout():
        import pybullet

        client = pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(0.0, 0.0, -GRAVITY, physicsClientId=client)
    return pybullet, client
