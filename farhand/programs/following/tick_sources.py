"""Where a recorder's and a viewer's ticks come from: an operator's program, and an emulator's."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TypeVar

import msgspec
import zenoh

from farhand.common.errors import RunFileError
from farhand.common.link.zenoh_link import open_session
from farhand.common.messages.keys import ticks_key
from farhand.common.recording.batch import TickBatch, TicksWanted
from farhand.common.recording.fates import FATES_KEY, FateBatch, FatesWanted

B = TypeVar("B")
ANSWER_WITHIN = 1.0


@contextmanager
def opened(endpoint: str) -> Iterator[zenoh.Session]:
    """A session that is closed at the end."""
    session = open_session([endpoint])
    try:
        yield session
    finally:
        session.close()  # type: ignore[no-untyped-call]


class Sources:
    """What is recorded from.

    Args:
        operator: session to the operator's program.
        netem: session to the emulator; None: it is not recorded.
        robot: the robot's name.
    """

    def __init__(self, operator: zenoh.Session, netem: zenoh.Session | None, robot: str) -> None:
        self._operator, self._netem, self._key = operator, netem, ticks_key(robot)

    def ticks(self, since: int, written: int | None = None) -> TickBatch | None:
        """The ticks from a number on; None: nobody answers. Raises RunFileError where the answer cannot be read.

        `written` says, for those who drive, up to which number ticks are in a file.
        """
        return _ask(self._operator, self._key, TicksWanted(since=since, written=written), TickBatch)

    def connected(self) -> bool:
        """Whether the operator's program is connected: it may be, and be too slow to answer."""
        info = self._operator.info
        return bool(info.peers_zid() or info.routers_zid())

    def fates(self, since: int) -> FateBatch | None:
        """The same of what became of messages."""
        if self._netem is None:
            return None
        return _ask(self._netem, FATES_KEY, FatesWanted(since=since), FateBatch)


def _ask(session: zenoh.Session, key: str, wanted: object, kind: type[B]) -> B | None:
    payload = msgspec.json.encode(wanted)
    for reply in session.get(key, payload=payload, timeout=ANSWER_WITHIN):
        if reply.ok is None:
            continue
        try:
            return msgspec.msgpack.decode(reply.ok.payload.to_bytes(), type=kind)
        except (msgspec.MsgspecError, ValueError) as error:
            raise RunFileError(
                f"an answer for {key} cannot be read: {' '.join(str(error).split())}; is it another version?"
            ) from None
    return None
