"""Virtual time: a total order of events, and computing that takes its time."""

import pytest

from farhand.common.link.link import Packet
from farhand.common.timing.clock import VirtualClock
from farhand.laboratory.virtual_executor import Priority, VirtualExecutor


class Beat:
    """Notes when it is stepped and what it received then; sends if it has a period, which it asks to be woken after."""

    def __init__(self, name, log, period=None, link=None):
        self.name, self.log, self.period, self.link = name, log, period, link

    def step(self, now_ns):
        got = [] if self.link is None else [(p.payload, p.arrived_ns) for p in self.link.receive()]
        self.log.append((now_ns, self.name, *got))
        if self.link is not None and self.period:
            self.link.send(Packet("k", b"%d" % now_ns))
        return None if self.period is None else now_ns + self.period


@pytest.fixture
def executor():
    return VirtualExecutor()


@pytest.fixture
def log():
    return []


def test_events_of_one_instant_run_robot_netem_operator_whatever_the_order_of_adding(log):
    executor = VirtualExecutor(100)
    executor.add(Beat("operator", log, 10), Priority.OPERATOR)
    executor.add(Beat("netem", log, 5), Priority.NETEM)
    executor.add(Beat("robot", log, 10), Priority.ROBOT)
    executor.run_until(110)
    assert log == [
        (100, "robot"), (100, "netem"), (100, "operator"), (105, "netem"),
        (110, "robot"), (110, "netem"), (110, "operator"),
    ]  # fmt: skip
    assert executor.clock.now_ns() == 110


def test_equal_priorities_run_in_the_order_of_adding_and_of_asking(executor, log):
    for name in "abc":
        executor.add(Beat(name, log, 5), Priority.NETEM)
    executor.run_until(5)
    assert [name for _, name in log] == list("abcabc")
    asked = []
    for number in range(20):
        executor.call_at(7, Priority.NETEM, lambda now, n=number: asked.append(n))
    executor.run_until(7)
    assert asked == list(range(20))


def sending(executor, log, computing_time):
    """An operator that sends every 100 ns after having computed, and a robot that is woken by what arrives."""
    mine, theirs = executor.wire()
    receiver = Beat("robot", log, None, theirs)
    executor.add(receiver, Priority.ROBOT)
    executor.wake_on_message(receiver, theirs)
    executor.add(Beat("operator", log, 100, mine), Priority.OPERATOR, computing_time)


def test_what_a_computing_node_sends_leaves_when_it_has_computed(executor, log):
    sending(executor, log, lambda: 30)
    executor.run_until(150)
    assert log == [
        (0, "robot"), (0, "operator"), (30, "robot", (b"0", 30)),
        (100, "operator"), (130, "robot", (b"100", 130)),
    ]  # fmt: skip


def test_computing_time_is_drawn_for_every_step(executor, log):
    costs = iter([5, 50, 5, 5])
    sending(executor, log, lambda: next(costs))
    executor.run_until(320)
    assert [t for t, name, *got in log if got] == [5, 150, 205, 305]


@pytest.mark.parametrize(("cost", "times"), [(25, [0, 25, 50, 75, 100]), (35, [0, 35, 70])])
def test_a_computing_node_is_not_woken_before_it_is_done(executor, log, cost, times):
    executor.add(Beat("slow", log, 10), Priority.OPERATOR, lambda: cost)
    executor.run_until(100)
    assert [t for t, _ in log] == times


def test_a_message_wakes_early_and_the_later_wake_up_is_superseded(executor, log):
    mine, theirs = executor.wire()
    sleeper = Beat("sleeper", log, 100)
    executor.add(sleeper, Priority.NETEM)
    executor.wake_on_message(sleeper, theirs)
    executor.call_at(40, Priority.ROBOT, lambda now: mine.send(Packet("k", b"x")))
    executor.run_until(150)
    assert [t for t, _ in log] == [0, 40, 140]


def test_a_node_that_sleeps_for_ever_is_called_once_and_then_by_messages_alone(executor, log):
    mine, theirs = executor.wire()
    quiet = Beat("quiet", log)
    executor.add(quiet, Priority.NETEM)
    executor.wake_on_message(quiet, theirs)
    executor.run_until(10**12)
    assert log == [(0, "quiet")]
    assert executor.events == 1
    assert executor.clock.now_ns() == 10**12
    executor.call_at(10**12 + 7, Priority.ROBOT, lambda now: mine.send(Packet("k", b"x")))
    executor.run_until(2 * 10**12)
    assert log == [(0, "quiet"), (10**12 + 7, "quiet")]


def test_it_ends_where_the_condition_holds_and_goes_on_from_there(executor, log):
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


def test_a_node_that_runs_on_lets_in_what_is_due_between_and_ends_in_time(executor, log):
    executor.add(Beat("robot", log, 2), Priority.ROBOT)
    executor.call_at(5, Priority.OPERATOR, lambda now_ns: log.append((now_ns, "between")))
    executor.call_at(8, Priority.NETEM, lambda now_ns: log.append((now_ns, "with it")))
    executor.run_until(9)
    beats = [(now_ns, "robot") for now_ns in (0, 2, 4, 6, 8)]
    assert log == [*beats[:3], (5, "between"), *beats[3:], (8, "with it")]
    assert executor.clock.now_ns() == 9
    executor.run_until(20, lambda: len(log) >= 9)
    assert log[7:] == [(10, "robot"), (12, "robot")]
