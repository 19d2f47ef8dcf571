"""An emulator that went on for long before a run: the recording and its network have the run's messages alone."""

import pytest

from farhand.common.link.link import Packet
from farhand.common.messages.codec import encode
from farhand.common.recording.batch import TickBatch
from farhand.common.recording.fates import FateBatch
from farhand.common.recording.records import RunInfo, TickRecord
from farhand.common.recording.run_file import RunFile
from farhand.laboratory.virtual_executor import Priority, VirtualExecutor
from farhand.netem.emulation import Emulation
from farhand.netem.impairments.recorded import recorded_fates
from farhand.netem.measure.fate_history import FateHistory
from farhand.netem.netem_node import NetemNode
from farhand.netem.spec import parse_spec
from farhand.programs.following.followed_run import FollowedRun
from farhand.testing import command, report, state

MS, BEFORE, OF_RUN, ELSEWHERE = 1_000_000, 5, 6, 7
START_MS, TICK_MS, TICKS = 60_000, 100, 20
OPERATOR_NS = 3_600_000 * MS
"""The operator's clock less the emulator's: two hosts."""


def tick(number):
    at_ns = START_MS * MS + number * TICK_MS * MS + OPERATOR_NS
    payload = encode(command(session=OF_RUN, seq=number, t_sent_ns=at_ns))
    return TickRecord(number, at_ns, (), payload, encode(report(number)))


@pytest.fixture(scope="module")
def answer():
    """What an emulator says after a run of another operator, an idle minute, another network and this run."""
    executor, history = VirtualExecutor(1000), FateHistory()
    (operator, near), (far, robot) = executor.wire(), executor.wire()
    slow, fast = parse_spec("constant:100"), parse_spec("constant:20")
    node = NetemNode(near, far, Emulation(slow, slow, 1), logs=[history])
    executor.add(node, Priority.NETEM)
    for link in (near, far):
        executor.wake_on_message(node, link)

    def at(ms, link, key, payload):
        executor.call_at(1000 + ms * MS, Priority.OPERATOR, lambda _: link.send(Packet(key, payload)))

    end = START_MS + TICKS * TICK_MS
    for ms in range(0, end, 20):
        at(ms, robot, "farhand/r/state", encode(state(seq=ms)))
    for ms in range(0, 5000, TICK_MS):
        at(ms, operator, "farhand/r/command", encode(command(session=BEFORE, seq=ms)))
    for number in range(TICKS):
        at(START_MS + number * TICK_MS, operator, "farhand/r/command", tick(number).command)
    executor.run_until(1000 + (START_MS - 500) * MS)
    for direction in node.directions.values():
        direction.set_spec(fast)
    executor.run_until(1000 + (end + 500) * MS)

    def batch(since):
        first, fates, more = history.since(since)
        return FateBatch(
            session=1,
            first=first,
            fates=fates,
            more=more,
            epoch_ns=1,
            uplink="",
            downlink="",
            seed=1,
            sessions_ns=node.sessions_ns(),
        )

    return batch


class Sources:
    def __init__(self, answer):
        self.fates = answer


def follow(answer, path, session, ticks):
    run = FollowedRun(lambda info: RunFile(path, info))
    info = RunInfo(scenario={}, robot="r", session=session, seed=1, versions={})
    run.take_all_fates(Sources(answer))
    if ticks[0].number == 0:  # it may be found before its first tick
        run.take(TickBatch(info=info, ticks=(), more=True, ended=False))
        run.take_all_fates(Sources(answer))
    run.take(TickBatch(info=info, ticks=ticks, more=False, ended=True))
    run.take_all_fates(Sources(answer))
    run.close()
    return run


@pytest.mark.parametrize("late", [0, 5])
def test_what_came_by_before_the_first_tick_is_not_of_the_run(answer, tmp_path, late):
    path = tmp_path / "run.mcap"
    run = follow(answer, path, OF_RUN, tuple(tick(number) for number in range(late, TICKS)))
    ticks = TICKS - late
    assert run.fates == ticks + ticks * TICK_MS // 20
    assert run.missing_fates == 0
    network = recorded_fates(str(path))
    for way, key in (("uplink", "farhand/r/command"), ("downlink", "farhand/r/state")):
        course = network.of(way, key)
        assert course._arrivals_ns[0] == 0
        assert {fate.assigned_ns for fates in course._fates for fate in fates} == {20 * MS}


def test_of_a_run_whose_commands_went_another_way_nothing_is_taken_and_that_is_known(answer, tmp_path):
    run = follow(answer, tmp_path / "run.mcap", ELSEWHERE, (tick(0),))
    assert run.fates == 0
    assert run.elsewhere
