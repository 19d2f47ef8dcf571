"""An emulator's half of `farhand record`: what became of the newest messages, for whoever comes for it."""

import msgspec
import zenoh

from farhand.common.link.requests import Desk, Request, Requests
from farhand.common.recording.fates import FATES_KEY, FateBatch, FatesWanted
from farhand.common.timing.clock import SystemClock
from farhand.netem.measure.fate_history import FateHistory
from farhand.netem.netem_node import NetemNode


class FateServer:
    """Args:
    history: what is given.
    node: whose networks they are.
    clock: of this process.
    session: where requests come from, on this host only.
    seed: of the draws.
    """

    def __init__(
        self, history: FateHistory, node: NetemNode, clock: SystemClock, session: zenoh.Session, seed: int
    ) -> None:
        self._history, self._node, self._seed = history, node, seed
        self._epoch_ns = clock.epoch_ns()
        self._session = clock.now_ns()  # this start's: what is given elsewhere under a number is not of it
        self._desk = Desk("fates", self._look, Requests(session, FATES_KEY))

    def close(self) -> None:
        """Answer nobody any more."""
        self._desk.close()

    def answer(self, payload: bytes) -> FateBatch | None:
        """The batch that a request asks for; None: it is none."""
        try:
            wanted = msgspec.json.decode(payload, type=FatesWanted)
        except (msgspec.MsgspecError, ValueError, RecursionError):
            return None
        first, fates, more = self._history.since(wanted.since)
        ways = self._node.directions
        return FateBatch(
            session=self._session,
            first=first,
            fates=fates,
            more=more,
            epoch_ns=self._epoch_ns + self._node.origin_ns if self._node.origin_ns else 0,
            uplink=str(ways["uplink"].chain.spec),
            downlink=str(ways["downlink"].chain.spec),
            seed=self._seed,
            sessions_ns=self._node.sessions_ns(),
        )

    def _look(self, request: Request | None) -> None:
        if request is not None:
            batch = self.answer(request.payload)
            answer = b"" if batch is None else msgspec.msgpack.encode(batch)
            request.reply(answer, zenoh.Encoding.APPLICATION_OCTET_STREAM)
