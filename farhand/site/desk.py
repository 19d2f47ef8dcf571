"""What an operator's program does for a command on its host: take requests, change the node, answer when settled."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING

import zenoh

from farhand.common.link.requests import Desk, Request, Requests, refusal
from farhand.common.timing.clock import SystemClock
from farhand.common.timing.slot import NotServedError, Slot

if TYPE_CHECKING:
    from farhand.operator_side.operator_node import OperatorNode

GIVE_UP_NS = 4_000_000_000
"""The robot has this long to confirm what was asked."""


class OperatorDesk(ABC):
    """In a thread of its own; it changes the node through the slot alone.

    Args:
        node: the operator's node.
        slot: served by the node's loop.
        clock: of this process.
        session: where requests come from, on this host only.
        robot: the robot's name.
        tell: takes a line for people.
    """

    name: str

    def __init__(
        self,
        node: "OperatorNode",
        slot: Slot,
        clock: SystemClock,
        session: zenoh.Session,
        robot: str,
        tell: Callable[[str], None],
    ) -> None:
        self._node, self._slot, self._say = node, slot, tell
        self._pending: list[Request] = []
        requests = Requests(session, self.key(robot))
        self._desk = Desk(self.name, lambda request: self.look(request, clock.now_ns()), requests)

    @staticmethod
    @abstractmethod
    def key(robot: str) -> str:
        """Where requests are heard."""

    @abstractmethod
    def look(self, request: Request | None, now_ns: int) -> None:
        """Begin with a request if one has come, and answer those that are settled."""

    def close(self) -> None:
        """Look no more."""
        self._desk.close()

    def _has_done(self, change: Callable[["OperatorNode"], object], request: Request) -> bool:
        """Have the node's loop make a change, and keep the request for its answer; else refuse it."""
        try:
            self._slot.do(lambda _: change(self._node))
        except NotServedError as error:
            request.reply(refusal(str(error)))
            return False
        self._pending.append(request)
        return True

    def _answer(self, answer: bytes) -> None:
        for request in self._pending:
            request.reply(answer)
        self._pending.clear()
