"""A thread of Zenoh's that calls Python again and again keeps what Python knows of it."""

import threading

import pytest
import zenoh

from farhand.common.link.ports import free_ports
from farhand.common.link.zenoh_link import open_session
from farhand.common.link.zenoh_threads import resident


@pytest.mark.realtime
def test_a_thread_that_calls_again_is_still_known():
    (port,) = free_ports(1)
    endpoint, known, again = f"tcp/127.0.0.1:{port}", threading.local(), threading.Event()

    def take(_):
        known.calls = getattr(known, "calls", 0) + 1  # gone with the state, where that is thrown away
        if known.calls > 1:
            again.set()

    with open_session(listen=[endpoint]) as there, open_session([endpoint]) as here:
        here.declare_subscriber("key", zenoh.handlers.Callback(resident(take), indirect=False))
        for _ in range(600):
            there.put("key", b"")
            if again.wait(0.1):
                return
    pytest.fail("each call was the first of its thread")
