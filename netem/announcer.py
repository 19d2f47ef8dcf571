"""What the emulator's program says to people while it runs."""

from collections.abc import Callable

from farhand.netem.netem_node import NetemNode

BYPASSED = "a robot answers a command that the emulator did not let through: something goes past it"


class Announcer:
    """Looks after each step at what the node has noted.

    Args:
        say: takes a line for people; called in the node's thread, so it must only hand it over.
        node: the emulator.
    """

    def __init__(self, say: Callable[[str], None], node: NetemNode) -> None:
        self._say, self._node = say, node
        self._bypass_said = False

    def look(self, now_ns: int) -> None:
        """Say what is new."""
        for line in self._node.take_notes():
            self._say(line)
        if not self._bypass_said and any(t.bypassed for t in self._node.round_trips.values()):
            self._bypass_said = True
            self._say(BYPASSED)
