"""The laboratory: operator, network and robot in one process under a virtual clock.

The nodes are those of the programs, made by the same wiring, joined by in-memory links. Nothing here reads a
clock: the same scenario, network and seed give the same bytes.
"""

import hashlib
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

from farhand.common.link.link import MemoryLink, Packet
from farhand.common.messages.report import ControlReport
from farhand.common.recording.recorder import RunInfo, RunRecorder
from farhand.common.timing.clock import to_ns, to_seconds
from farhand.laboratory.virtual_executor import Priority, VirtualExecutor
from farhand.operator_side.control.controller import Controller
from farhand.operator_side.control.registry import make_controller
from farhand.operator_side.operator_node import OperatorIdentity, OperatorNode
from farhand.programs.wiring import (
    OPERATOR_NAME,
    make_netem,
    make_operator,
    make_robot_node,
    session_of,
    versions,
)
from farhand.robot_side.robots.registry import make_robot
from farhand.robot_side.robots.robot import Robot
from farhand.runs.scenario import Scenario, scenario_to_table
from farhand.runs.summary import RunSummary, Tally, summarise

COMPUTING_TIME = 0.02
"""Modelled duration of a control tick (s): zero would flatter the controller."""
START_NS = 1_000_000_000

Trajectory = list[tuple[float, float, float, float, float]]


@dataclass
class SimulationResult:
    """Attributes:
    summary: see RunSummary.
    trajectory: (t, x, y, z, clearance) at 50 Hz at most; t in s from the robot's start, m.
    reports: of every tick, where asked for.
    digest: SHA-256 over every message that left or reached the operator, in order.
    network: the emulator's statistics.
    """

    summary: RunSummary
    trajectory: Trajectory
    digest: str
    network: dict[str, object]
    reports: list[ControlReport] = field(default_factory=list)


class _TallyingOperator:
    """The operator node, with its reports looked at after each tick."""

    def __init__(self, node: OperatorNode, look: Callable[[ControlReport], None]) -> None:
        self._node, self._look = node, look
        self._seen: ControlReport | None = None

    def step(self, now_ns: int) -> int:
        next_ns = self._node.step(now_ns)
        if self._node.report is not None and self._node.report is not self._seen:
            self._seen = self._node.report
            self._look(self._seen)
        return next_ns


def simulate(
    scenario: Scenario,
    *,
    uplink: str | None = None,
    downlink: str | None = None,
    seed: int = 0,
    time_limit: float = 90.0,
    computing_time: float | Callable[[], float] = COMPUTING_TIME,
    keep_reports: bool = False,
    record_to: Path | None = None,
    digest: bool = False,
    timeline: str | None = None,
    controller: Controller | None = None,
    robot: Robot | None = None,
) -> SimulationResult:
    """Run one task in virtual time.

    Args:
        scenario: what to do.
        uplink, downlink: SPECs; None takes the scenario's.
        seed: of every random stream.
        time_limit: of the task, from the first motion command (s).
        computing_time: of a control tick (s), constant or drawn for each.
        keep_reports: keep every ControlReport.
        record_to: file for a recording that can be replayed.
        digest: hash every message.
        timeline: TOML file of changes of the network at given times.
        controller, robot: in place of the scenario's; fresh, as they keep state; the caller closes the robot.
    """
    uplink = scenario.network.uplink if uplink is None else uplink
    downlink = scenario.network.downlink if downlink is None else downlink
    name = scenario.robot.kind
    executor = VirtualExecutor(START_NS)
    operator_end, netem_operator_end = executor.wire()
    netem_robot_end, robot_end = executor.wire()
    hasher = hashlib.sha256()
    if digest:
        _hash_traffic(operator_end, hasher.update)
    with ExitStack() as closing:
        if robot is None:
            robot = make_robot(scenario)
            closing.callback(robot.close)  # a world of PyBullet is 30 MB that stay otherwise
        robot_node = make_robot_node(scenario, robot_end, name, session_of(seed, "robot"), robot)
        netem = make_netem(netem_operator_end, netem_robot_end, uplink, downlink, seed, timeline)
        session = session_of(seed, "operator")
        controller = make_controller(scenario.controller) if controller is None else controller
        controller.prepare()
        operator = make_operator(
            scenario, operator_end, OperatorIdentity(name, session, OPERATOR_NAME), controller
        )
        recorder = _recorder(record_to, scenario, name, session, seed)
        if recorder is not None:
            closing.callback(recorder.close)
        operator.recorder = recorder
        tally, reports = Tally(), []

        def look(report: ControlReport) -> None:
            tally.add(report)
            if keep_reports:
                reports.append(report)

        executor.add(robot_node, Priority.ROBOT)
        executor.add(netem, Priority.NETEM)
        executor.add(_TallyingOperator(operator, look), Priority.OPERATOR, _cost(computing_time))
        for link in (netem_operator_end, netem_robot_end):
            executor.wake_on_message(netem, link)
        end_ns = _run(executor, operator, to_ns(time_limit))
        netem.check_conservation()
        since = operator.driving_since_ns
        summary = summarise(
            scenario,
            seed=seed,
            uplink=uplink,
            downlink=downlink,
            tally=tally,
            robot=robot_node.summary(),
            finished=operator.finished,
            duration=to_seconds(end_ns - since) if since is not None else 0.0,
            rtt=operator.round_trip.overall(),
            solver=controller.settings.solver,
            real_time=False,
            why="" if operator.finished else _why(tally, time_limit),
        )
        return SimulationResult(
            summary, robot_node.trajectory, hasher.hexdigest(), netem.statistics(), reports
        )


def _run(executor: VirtualExecutor, operator: OperatorNode, limit_ns: int) -> int:
    """Until finished, or the limit after the first motion command (or after the start, if there is none)."""
    start_ns = executor.clock.now_ns()
    executor.run_until(start_ns + limit_ns, lambda: operator.driving_since_ns is not None)
    if operator.driving_since_ns is not None:
        executor.run_until(operator.driving_since_ns + limit_ns, lambda: operator.finished)
    return executor.clock.now_ns()


def _cost(computing_time: float | Callable[[], float]) -> Callable[[], int]:
    if callable(computing_time):
        draw = computing_time
        return lambda: to_ns(draw())
    constant = to_ns(computing_time)
    return lambda: constant


def _why(tally: Tally, time_limit: float) -> str:
    if tally.last is None:
        return "the operator never ran"
    reached, count = tally.last.target_index, tally.last.target_count
    reason = f"; at the end: {tally.last.stop_reason}" if tally.last.stop_reason else ""
    return f"not finished within {time_limit:g} s: {reached} of {count} targets reached{reason}"


def _recorder(
    path: Path | None, scenario: Scenario, name: str, session: int, seed: int
) -> RunRecorder | None:
    if path is None:
        return None
    info = RunInfo(
        scenario=scenario_to_table(scenario),
        robot=name,
        session=session,
        seed=seed,
        versions=versions(),
        solver=scenario.controller.solver,
    )
    return RunRecorder(path, info)


def _hash_traffic(end: MemoryLink, update: Callable[[bytes], None]) -> None:
    """Feed every packet that leaves or reaches this end to a hash, with its stamp."""
    send, deliver = end.send, end.deliver

    def hashed_send(packet: Packet) -> None:
        update(b">" + packet.key.encode() + packet.payload)
        send(packet)

    def hashed_deliver(packet: Packet, now_ns: int) -> None:
        update(b"<%d" % now_ns + packet.key.encode() + packet.payload)
        deliver(packet, now_ns)

    end.send, end.deliver = hashed_send, hashed_deliver  # type: ignore[method-assign]
