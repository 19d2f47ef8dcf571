"""Many nodes in one process under a virtual clock: the same seed gives the same bytes.

One heap ordered by (time, priority, counter). A node that computes is charged a modelled time: what it
sends leaves that much later, and it is not woken again before.
"""

import heapq
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import IntEnum
from functools import partial

from farhand.common.link.link import MemoryLink, Packet, memory_wire
from farhand.common.timing.clock import VirtualClock
from farhand.common.timing.node import Node


class Priority(IntEnum):
    """Order of events at the same instant."""

    ROBOT = 0
    NETEM = 1
    OPERATOR = 2


@dataclass(slots=True)
class _Slot:
    node: Node
    priority: Priority
    computing_time: Callable[[], int] | None
    wake_ns: int | None = None
    busy_until_ns: int = 0
    wake: Callable[[int], None] = field(init=False)


class VirtualExecutor:
    """Event-driven executor over integer nanoseconds."""

    def __init__(self, start_ns: int = 0) -> None:
        self.clock = VirtualClock(start_ns)
        self.events = 0
        self._heap: list[tuple[int, int, int, Callable[[int], None]]] = []
        self._counter = 0
        self._send_ns = start_ns
        self._send_priority = Priority.ROBOT
        self._slots: list[_Slot] = []
        self._end_ns = start_ns
        self._decides: Priority | None = None
        self._asked = False

    def add(self, node: Node, priority: Priority, computing_time: Callable[[], int] | None = None) -> None:
        """Add a node; its first step is now. `computing_time` models each step's duration (ns)."""
        slot = _Slot(node, priority, computing_time)
        slot.wake = partial(self._step, slot)
        self._wake(slot, self.clock.now_ns())
        self._slots.append(slot)

    def remove(self, node: Node) -> None:
        """A node that no message wakes steps no more; what it has sent is delivered."""
        for slot in self._slots:
            if slot.node is node:
                slot.wake_ns = None
        self._slots = [slot for slot in self._slots if slot.node is not node]

    def wire(self) -> tuple[MemoryLink, MemoryLink]:
        """Two joined link ends whose deliveries honour the sender's computing time."""
        return memory_wire(self._transmit)

    def wake_on_message(self, node: Node, link: MemoryLink) -> None:
        """Step `node` whenever a packet arrives at `link`."""
        slot = next(s for s in self._slots if s.node is node)
        link.on_arrival = lambda now_ns: self._wake(slot, now_ns)

    def call_at(self, instant_ns: int, priority: Priority, call: Callable[[int], None]) -> None:
        """Call `call(now_ns)` at the given instant."""
        self._counter += 1
        heapq.heappush(self._heap, (instant_ns, priority, self._counter, call))

    def run_until(
        self,
        end_ns: int,
        finished: Callable[[], bool] | None = None,
        decides: Priority | None = None,
    ) -> None:
        """Process events up to and including `end_ns`, or until `finished()` holds.

        Args:
            end_ns: last instant.
            finished: asked after every event.
            decides: asked only after those of this priority.
        """
        heap, advance_to = self._heap, self.clock.advance_to
        self._end_ns, self._decides, self._asked = end_ns, decides, finished is not None
        while heap and heap[0][0] <= end_ns:
            instant_ns, priority, _, call = heapq.heappop(heap)
            advance_to(instant_ns)
            self.events += 1
            call(instant_ns)
            if finished is not None and (decides is None or priority is decides) and finished():
                return
        advance_to(max(end_ns, self.clock.now_ns()))

    def _wake(self, slot: _Slot, instant_ns: int) -> None:
        if instant_ns < slot.busy_until_ns:
            instant_ns = slot.busy_until_ns
        if slot.wake_ns is not None and slot.wake_ns <= instant_ns:
            return
        slot.wake_ns = instant_ns
        self._counter += 1
        heapq.heappush(self._heap, (instant_ns, slot.priority, self._counter, slot.wake))

    def _step(self, slot: _Slot, now_ns: int) -> None:
        if slot.wake_ns != now_ns:
            return  # superseded by an earlier wake-up
        slot.wake_ns = None
        done_ns = now_ns if slot.computing_time is None else now_ns + slot.computing_time()
        slot.busy_until_ns = self._send_ns = done_ns
        self._send_priority = slot.priority
        step, heap, priority = slot.node.step, self._heap, slot.priority
        asked = self._asked and (self._decides is None or self._decides is priority)
        in_a_row = slot.computing_time is None and not asked
        next_ns = step(now_ns)
        while (
            in_a_row
            and next_ns is not None
            and now_ns < next_ns <= self._end_ns
            and slot.wake_ns is None
            and (not heap or heap[0][0] > next_ns or heap[0][:2] > (next_ns, priority))
        ):
            # Nothing comes before its next step, after which nobody asks whether to end: a robot makes many of them in
            # a row, at no cost of the heap.
            now_ns = next_ns
            self.clock.advance_to(now_ns)
            self.events += 1
            self._send_ns = now_ns
            next_ns = step(now_ns)
        self._send_ns = now_ns
        if next_ns is not None:
            self._wake(slot, next_ns)

    def _transmit(self, receiver: MemoryLink, packet: Packet) -> None:
        now_ns = self.clock.now_ns()
        if self._send_ns <= now_ns:
            receiver.deliver(packet, now_ns)
        else:
            self.call_at(self._send_ns, self._send_priority, lambda now_ns: receiver.deliver(packet, now_ns))
