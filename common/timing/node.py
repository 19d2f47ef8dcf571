"""What a loop calls."""

from typing import Protocol


class Node(Protocol):
    """A synchronous participant of the system; owns no clock, no thread, no socket.

    A node that reports has `listeners`, a plain list of callables, and calls each with every report, at the
    end of the step that made it. They run in the node's thread, so they only count and hand over.
    """

    def step(self, now_ns: int) -> int | None:
        """Do all that is due at `now_ns`.

        Returns the absolute instant (ns) of the next wake-up, or None to sleep until a message arrives.
        """
        ...
