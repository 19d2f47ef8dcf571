"""Requests to a running program: a Zenoh queryable on an endpoint that only this host can reach.

Requests are JSON, replies are JSON too: `{"ok": true, ...}` or `{"ok": false, "error": "..."}`.
"""

import threading
from collections import deque
from collections.abc import Callable
from typing import Any

import msgspec
import zenoh

from farhand.common.errors import InputError
from farhand.common.link.zenoh_link import open_session

MAX_REQUEST = 65_536
MAX_WAITING = 64


class Request:
    """One request; to be answered once.

    Args:
        key: of the queryable.
        query: as it came.
    """

    def __init__(self, key: str, query: zenoh.Query) -> None:
        self._key, self._query = key, query
        self.payload = query.payload.to_bytes() if query.payload is not None else b""

    def reply(self, answer: bytes) -> None:
        """Answer it, and be done with it."""
        try:
            self._query.reply(self._key, answer, encoding=zenoh.Encoding.APPLICATION_JSON)
        except zenoh.ZError:
            pass  # whoever asked is gone
        finally:
            self._query.drop()  # type: ignore[no-untyped-call]


class Requests:
    """Takes requests in a Zenoh thread, for a program's own thread to answer.

    Args:
        session: open, on loopback; whoever opened it closes it.
        key: of the queryable.
        wake: called when a request has come, in a Zenoh thread.
    """

    def __init__(self, session: zenoh.Session, key: str, wake: Callable[[], None] | None = None) -> None:
        self._key, self._wake = key, wake
        self._queries: deque[zenoh.Query] = deque(maxlen=MAX_WAITING)
        self._queryable = session.declare_queryable(key, self._take)

    def pop(self) -> Request | None:
        """The oldest request that has not been looked at."""
        return Request(self._key, self._queries.popleft()) if self._queries else None

    def _take(self, query: zenoh.Query) -> None:
        self._queries.append(query)
        if self._wake is not None:
            self._wake()


def ask(
    endpoint: str, key: str, request: object, nobody: str, timeout: float = 3.0, meeting: float = 3.0
) -> dict[str, Any]:
    """Send a request to a running program; its reply.

    Args:
        endpoint: where it listens.
        key: of its queryable.
        request: what is sent as JSON.
        nobody: what to say when nobody answers.
        timeout: for the answer (s).
        meeting: for the connection (s).

    Raises:
        InputError: nobody answers there, or the program refused the request.
    """
    connected = threading.Event()
    session = open_session([endpoint])
    try:
        session.info.declare_transport_events_listener(lambda _: connected.set(), history=True)
        found: dict[str, Any] | None = None
        if connected.wait(meeting):
            for reply in session.get(key, payload=msgspec.json.encode(request), timeout=timeout):
                if reply.ok is not None:
                    found = msgspec.json.decode(reply.ok.payload.to_bytes())
    finally:
        session.close()  # type: ignore[no-untyped-call]
    if found is None:
        raise InputError(nobody)
    if not found.get("ok"):
        raise InputError(str(found.get("error", "the request was refused")))
    return found
