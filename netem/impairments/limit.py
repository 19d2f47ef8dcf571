"""`limit:N`: at most N messages of a direction are under way; one more is dropped (tc: `limit N`).

Counted are those that entered and have not left, delayed ones and those that wait for a rate alike, as in tc-netem.
"""

import heapq
from typing import ClassVar

from farhand.netem.impairments.base import Impairment, ImpairmentContext, Scope, Stage, Transit, Word
from farhand.netem.words.reader import SpecReader


class Limit(Word, frozen=True):
    """A bound of the messages under way.

    Attributes:
        count: of messages.
    """

    count: int
    name: ClassVar[str] = "limit"
    example: ClassVar[str] = "limit:1000"
    description: ClassVar[str] = "at most a thousand messages are under way"
    kind: ClassVar[str] = "limit"
    stage: ClassVar[Stage] = Stage.LIMIT
    scope: ClassVar[Scope] = Scope.LINK

    @classmethod
    def parse(cls, reader: SpecReader) -> "Limit":
        """`:N`."""
        reader.expect(":", "how many messages may be under way")
        return cls(reader.count("how many messages may be under way"))

    def text(self) -> str:
        """Canonical word."""
        return f"limit:{self.count}"

    def build(self, context: ImpairmentContext) -> Impairment:
        """The counter."""
        return _Limit(self.count)


class _Limit(Impairment):
    def __init__(self, count: int) -> None:
        self._count = count
        self._releases: list[int] = []

    def apply(self, transit: Transit) -> None:
        if transit.cause:
            return
        while self._releases and self._releases[0] <= transit.arrived_ns:
            heapq.heappop(self._releases)
        if len(self._releases) >= self._count:
            transit.cause = "limit"
            return
        heapq.heappush(self._releases, transit.release_ns)
