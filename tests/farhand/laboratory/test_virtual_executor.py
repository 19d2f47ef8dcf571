import pytest

from farhand.common.link.link import MemoryLink, Packet
from farhand.common.timing.clock import VirtualClock
from farhand.laboratory.virtual_executor import Priority, VirtualExecutor


class Ticker:
    """Notes when it is stepped; sends on every step if it has a link."""

    def __init__(self, name: str, journal: list, period: int | None, link: MemoryLink | None = None) -> None:
        self.name, self.journal, self.period, self.link = name, journal, period, link

    def step(self, now_ns: int) -> int | None:
        self.journal.append((now_ns, self.name))
        if self.link is not None:
            self.link.send(Packet("k", b"%d" % now_ns))
        return None if self.period is None else now_ns + self.period


class Listener:
    def __init__(self, journal: list, link: MemoryLink) -> None:
        self.journal, self.link = journal, link

    def step(self, now_ns: int) -> None:
        for packet in self.link.receive():
            self.journal.append((now_ns, packet.arrived_ns, int(packet.payload)))


def test_at_the_same_instant_the_robot_comes_first_and_the_operator_last():
    journal: list = []
    executor = VirtualExecutor()
    for name, priority in (
        ("operator", Priority.OPERATOR),
        ("netem", Priority.NETEM),
        ("robot", Priority.ROBOT),
    ):
        executor.add(Ticker(name, journal, 10), priority)
    executor.run_until(20)
    assert journal == [(t, name) for t in (0, 10, 20) for name in ("robot", "netem", "operator")]


def test_equal_priorities_keep_the_order_in_which_they_were_added():
    journal: list = []
    executor = VirtualExecutor()
    for name in "abc":
        executor.add(Ticker(name, journal, 5), Priority.NETEM)
    executor.run_until(5)
    assert [name for _, name in journal] == list("abcabc")


def test_what_is_sent_leaves_when_the_computing_is_done():
    journal: list = []
    executor = VirtualExecutor()
    left, right = executor.wire()
    listener = Listener(journal, right)
    executor.add(listener, Priority.ROBOT)
    executor.wake_on_message(listener, right)
    executor.add(Ticker("o", [], 100, left), Priority.OPERATOR, lambda: 30)
    executor.run_until(250)
    assert journal == [(30, 30, 0), (130, 130, 100), (230, 230, 200)]


def test_a_node_that_still_computes_is_woken_when_it_is_done():
    journal: list = []
    executor = VirtualExecutor()
    executor.add(Ticker("slow", journal, 10), Priority.OPERATOR, lambda: 35)
    executor.run_until(100)
    assert [t for t, _ in journal] == [0, 35, 70]


def test_computing_time_is_drawn_for_every_step():
    costs = iter([5, 50, 5, 5])
    journal: list = []
    executor = VirtualExecutor()
    left, right = executor.wire()
    listener = Listener(journal, right)
    executor.add(listener, Priority.ROBOT)
    executor.wake_on_message(listener, right)
    executor.add(Ticker("o", [], 100, left), Priority.OPERATOR, lambda: next(costs))
    executor.run_until(320)
    assert [arrived for _, arrived, _ in journal] == [5, 150, 205, 305]


def test_nothing_wakes_when_nothing_is_due():
    executor = VirtualExecutor()
    left, right = executor.wire()
    quiet = Ticker("quiet", [], None)
    executor.add(quiet, Priority.NETEM)
    executor.wake_on_message(quiet, right)
    executor.run_until(10**12)
    assert executor.events == 1
    assert executor.clock.now_ns() == 10**12
    executor.call_at(10**12 + 7, Priority.ROBOT, lambda now_ns: left.send(Packet("k", b"x")))
    executor.run_until(2 * 10**12)
    assert quiet.journal == [(0, "quiet"), (10**12 + 7, "quiet")]


def test_run_ends_with_the_event_that_finishes():
    journal: list = []
    executor = VirtualExecutor()
    executor.add(Ticker("a", journal, 10), Priority.ROBOT)
    executor.run_until(1000, lambda: len(journal) == 3)
    assert executor.clock.now_ns() == 20
    executor.run_until(40)
    assert [t for t, _ in journal] == [0, 10, 20, 30, 40]


def test_virtual_time_never_runs_backwards():
    clock = VirtualClock(5)
    with pytest.raises(ValueError, match="backwards"):
        clock.advance_to(4)
