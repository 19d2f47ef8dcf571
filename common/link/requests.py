"""Requests to a running program: a Zenoh queryable on an endpoint that only this host can reach.

Requests are JSON, replies are JSON too: `{"ok": true, ...}` or `{"ok": false, "error": "..."}`; where a great deal is
asked for, they are MessagePack.
"""

import queue
import threading
from collections.abc import Callable
from typing import Any

import msgspec
import zenoh

from farhand.common.errors import InputError
from farhand.common.link.zenoh_link import open_session

MAX_REQUEST = 65_536
MAX_WAITING = 64
LOOK_EVERY = 0.05
CLOSING_TIME = 1.0


class Request:
    """One request; to be answered once.

    Args:
        key: of the queryable.
        query: as it came.
    """

    def __init__(self, key: str, query: zenoh.Query) -> None:
        self._key, self._query = key, query
        self.payload = query.payload.to_bytes() if query.payload is not None else b""

    def reply(self, answer: bytes, encoding: zenoh.Encoding = zenoh.Encoding.APPLICATION_JSON) -> None:
        """Answer it, and be done with it."""
        try:
            self._query.reply(self._key, answer, encoding=encoding)
        except zenoh.ZError:
            pass  # whoever asked is gone
        finally:
            self._query.drop()  # type: ignore[no-untyped-call]


class Requests:
    """Takes requests in a Zenoh thread, for the thread that answers them (see Desk).

    Args:
        session: open, on loopback; whoever opened it closes it.
        key: of the queryable.
    """

    def __init__(self, session: zenoh.Session, key: str) -> None:
        self._key = key
        self._queries: queue.Queue[zenoh.Query] = queue.Queue(MAX_WAITING)
        self._queryable = session.declare_queryable(key, self._take)

    def get(self, patience: float) -> Request | None:
        """The oldest request that has not been looked at; None if there is none for `patience` s."""
        try:
            return Request(self._key, self._queries.get(timeout=patience))
        except queue.Empty:
            return None

    def _take(self, query: zenoh.Query) -> None:
        try:
            self._queries.put_nowait(query)
        except queue.Full:
            Request(self._key, query).reply(refusal(f"{MAX_WAITING} requests are waiting; ask again later"))


class Desk:
    """The thread that answers requests, so that no loop does.

    Args:
        name: of the thread.
        look: called with a request, or with None when none has come for `every` s; must not raise.
        requests: None: none can come.
        every: see above (s).
    """

    def __init__(
        self,
        name: str,
        look: Callable[[Request | None], None],
        requests: Requests | None,
        every: float = LOOK_EVERY,
    ) -> None:
        self._look, self._requests, self._every = look, requests, every
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Answer nobody any more."""
        self._closing.set()
        self._thread.join(CLOSING_TIME)

    def _run(self) -> None:
        while not self._closing.is_set():
            if self._requests is None:
                self._closing.wait(self._every)
                self._look(None)
            else:
                self._look(self._requests.get(self._every))


def refusal(why: str) -> bytes:
    """The reply to a request that is not done: one line, whatever words of the request's it repeats."""
    return msgspec.json.encode({"ok": False, "error": " ".join(why.split())})


def answer_in(payload: bytes) -> dict[str, Any]:
    """The reply of a running program; raises InputError where it is none."""
    try:
        found = msgspec.json.decode(payload)
    except (msgspec.MsgspecError, ValueError, RecursionError) as error:
        raise InputError(f"the program's answer cannot be read: {' '.join(str(error).split())}") from None
    if not isinstance(found, dict):
        raise InputError("the program's answer cannot be read: it is no object")
    return found


class Asker:
    """Asks a running program, again and again, over one session.

    Args:
        endpoint: where it listens.
        key: of its queryable.
    """

    def __init__(self, endpoint: str, key: str) -> None:
        self._key, self._connected = key, threading.Event()
        self._session = open_session([endpoint])
        self._session.info.declare_transport_events_listener(lambda _: self._connected.set(), history=True)

    def ask(self, request: object, nobody: str, timeout: float = 3.0, meeting: float = 3.0) -> dict[str, Any]:
        """Send a request; its reply.

        Args:
            request: what is sent as JSON.
            nobody: what to say when nobody answers.
            timeout: for the answer (s).
            meeting: for the connection, where there has never been one (s).

        Raises:
            InputError: nobody answers there, or the program refused the request.
        """
        found: dict[str, Any] | None = None
        if self._connected.wait(meeting):
            for reply in self._session.get(self._key, payload=msgspec.json.encode(request), timeout=timeout):
                if reply.ok is not None:
                    found = answer_in(reply.ok.payload.to_bytes())
        if found is None:
            raise InputError(nobody)
        if not found.get("ok"):
            raise InputError(str(found.get("error", "the request was refused")))
        return found

    def close(self) -> None:
        """Ask no more."""
        self._session.close()  # type: ignore[no-untyped-call]


def ask(
    endpoint: str, key: str, request: object, nobody: str, timeout: float = 3.0, meeting: float = 3.0
) -> dict[str, Any]:
    """Send one request to a running program; its reply. See Asker."""
    asker = Asker(endpoint, key)
    try:
        return asker.ask(request, nobody, timeout, meeting)
    finally:
        asker.close()
