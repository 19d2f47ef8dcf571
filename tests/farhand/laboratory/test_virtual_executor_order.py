"""Virtual time: a total order of events, and computing that takes its time."""

import pytest

from farhand.common.link.link import Packet
from farhand.common.timing.clock import VirtualClock
from farhand.laboratory.virtual_executor import Priority, VirtualExecutor


class Beat:
    """Notes when it is stepped, sends a packet, and asks to be woken a period later."""

    def __init__(self, name, log, period=None, link=None):
        self.name, self.log, self.period, self.link = name, log, period, link

    def step(self, now_ns):
        if self.link is not None:
            got = [(p.payload, p.arrived_ns) for p in self.link.receive()]
        else:
            got = []
        self.log.append((now_ns, self.name, *got))
        if self.link is not None and self.period:
            self.link.send(Packet("k", self.name.encode()))
        return None if self.period is None else now_ns + self.period


def test_events_of_one_instant_run_robot_netem_operator_whatever_the_order_of_adding():
    log = []
    executor = VirtualExecutor(100)
    executor.add(Beat("operator", log, 10), Priority.OPERATOR)
    executor.add(Beat("netem", log, 5), Priority.NETEM)
    executor.add(Beat("robot", log, 10), Priority.ROBOT)
    executor.run_until(110)
    assert [(t, name) for t, name in log] == [
        (100, "robot"), (100, "netem"), (100, "operator"), (105, "netem"),
        (110, "robot"), (110, "netem"), (110, "operator"),
    ]  # fmt: skip
    assert executor.clock.now_ns() == 110


def test_equal_priorities_run_in_the_order_of_asking():
    executor, log = VirtualExecutor(), []
    for number in range(20):
        executor.call_at(7, Priority.NETEM, lambda now, n=number: log.append(n))
    executor.run_until(7)
    assert log == list(range(20))


def test_what_a_computing_node_sends_leaves_when_it_has_computed():
    executor, log = VirtualExecutor(), []
    mine, theirs = executor.wire()
    executor.add(Beat("operator", log, 100, mine), Priority.OPERATOR, lambda: 30)
    receiver = Beat("robot", log, None, theirs)
    executor.add(receiver, Priority.ROBOT)
    executor.wake_on_message(receiver, theirs)
    executor.run_until(150)
    assert log == [
        (0, "robot"), (0, "operator"), (30, "robot", (b"operator", 30)),
        (100, "operator"), (130, "robot", (b"operator", 130)),
    ]  # fmt: skip


def test_a_computing_node_is_not_woken_before_it_is_done():
    executor, log = VirtualExecutor(), []
    executor.add(Beat("slow", log, 10), Priority.OPERATOR, lambda: 25)
    executor.run_until(100)
    assert [t for t, _ in log] == [0, 25, 50, 75, 100]


def test_a_message_wakes_early_and_the_later_wake_up_is_superseded():
    executor, log = VirtualExecutor(), []
    mine, theirs = executor.wire()
    sleeper = Beat("sleeper", log, 100)
    executor.add(sleeper, Priority.NETEM)
    executor.wake_on_message(sleeper, theirs)
    executor.call_at(40, Priority.ROBOT, lambda now: mine.send(Packet("k", b"x")))
    executor.run_until(150)
    assert [t for t, _ in log] == [0, 40, 140]


def test_a_node_that_sleeps_for_ever_is_called_once_and_time_goes_on():
    executor, log = VirtualExecutor(), []
    executor.add(Beat("once", log), Priority.ROBOT)
    executor.run_until(1_000)
    assert log == [(0, "once")]
    assert executor.clock.now_ns() == 1_000
    assert executor.events == 1


def test_it_ends_where_the_condition_holds_and_goes_on_from_there():
    executor, log = VirtualExecutor(), []
    executor.add(Beat("robot", log, 10), Priority.ROBOT)
    executor.run_until(1_000, lambda: len(log) == 3)
    assert executor.clock.now_ns() == 20
    executor.run_until(40)
    assert [t for t, _ in log] == [0, 10, 20, 30, 40]


def test_virtual_time_never_runs_backwards():
    clock = VirtualClock(5)
    clock.advance_to(5)
    with pytest.raises(ValueError, match="backwards"):
        clock.advance_to(4)
