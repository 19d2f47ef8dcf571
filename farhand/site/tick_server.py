"""An operator's half of `farhand record`: gives the newest ticks to whoever comes for them, in a thread of its own."""

import threading
from collections.abc import Callable

import msgspec
import zenoh

from farhand.common.link.requests import Desk, Request, Requests
from farhand.common.messages.keys import ticks_key
from farhand.common.recording.batch import TickBatch, TicksWanted
from farhand.common.recording.records import RunInfo
from farhand.operator_side.accounts.tick_history import TickHistory

CONFIRMED_NS = 1_500_000_000
"""A recorder says some five times a second what it has written; silent for so long it is not writing."""
FAREWELL = 0.8
"""How long an ending program waits for a recorder that has come before (s)."""


class TickServer:
    """Args:
    history: what is given.
    info: of the run.
    session: where requests come from, on this host only.
    now_ns: this process's clock.
    """

    def __init__(
        self, history: TickHistory, info: RunInfo, session: zenoh.Session, now_ns: Callable[[], int]
    ) -> None:
        self._history, self._info, self._now_ns = history, info, now_ns
        self._written = -1
        self._written_ns: int | None = None
        self._ended = self._asked = False
        self._told_all = threading.Event()
        self._desk = Desk("ticks", self._look, Requests(session, ticks_key(info.robot)))

    def close(self) -> None:
        """Give a recorder that has come before the rest, then answer nobody any more."""
        self._ended = True
        if self._asked:
            self._told_all.wait(FAREWELL)
        self._desk.close()

    def answer(self, payload: bytes) -> TickBatch | None:
        """The batch that a request asks for; None: it is none."""
        try:
            wanted = msgspec.json.decode(payload, type=TicksWanted)
        except (msgspec.MsgspecError, ValueError, RecursionError):
            return None
        self._asked = True
        if wanted.written is not None and wanted.written > self._written:
            self._written, self._written_ns = wanted.written, self._now_ns()
        ended = self._ended  # before the ticks are looked at, so that "all" is not said too early
        ticks, more = self._history.since(wanted.since)
        return TickBatch(info=self._info, ticks=ticks, more=more, ended=ended and not more)

    def recording(self, now_ns: int) -> bool | msgspec.UnsetType:
        """Whether somebody has written further ticks to a file within CONFIRMED_NS; UNSET: nobody ever has."""
        written_ns = self._written_ns
        return msgspec.UNSET if written_ns is None else now_ns - written_ns < CONFIRMED_NS

    def _look(self, request: Request | None) -> None:
        if request is not None:
            batch = self.answer(request.payload)
            answer = b"" if batch is None else msgspec.msgpack.encode(batch)
            request.reply(answer, zenoh.Encoding.APPLICATION_OCTET_STREAM)
            if batch is not None and batch.ended:
                self._told_all.set()
