"""The laboratory: operator, network and robot in one process under a virtual clock.

The nodes are those of the programs, made by the same wiring, joined by in-memory links. Nothing here reads a
clock: the same run gives the same bytes.
"""

import hashlib
from collections.abc import Callable
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, TypedDict

import msgspec

from farhand.common.errors import InputError
from farhand.common.link.link import MemoryLink
from farhand.common.messages.report import ControlReport
from farhand.common.recording.fates import Fate
from farhand.common.recording.records import RunInfo
from farhand.common.recording.writer import RunRecorder
from farhand.common.seeds import stream
from farhand.common.timing.clock import to_ns, to_seconds
from farhand.foxglove.view import views_of
from farhand.laboratory.tap import Tap, hash_traffic, listen
from farhand.laboratory.virtual_executor import Priority, VirtualExecutor
from farhand.netem.measure.result import NetemResult
from farhand.operator_side.accounts.result import OperatorResult, Span, Tally
from farhand.operator_side.control.controller import Controller
from farhand.operator_side.control.registry import make_controller
from farhand.operator_side.operator_node import OperatorIdentity, OperatorNode
from farhand.operator_side.prepare import prepare
from farhand.programs.wiring import (
    OPERATOR_NAME,
    make_netem,
    make_operator,
    make_robot_node,
    session_of,
    source_state,
    versions,
)
from farhand.robot_side.robot_node import RobotNode
from farhand.robot_side.robots.registry import ROBOTS, make_robot
from farhand.robot_side.robots.robot import Robot
from farhand.runs.results import RunResults
from farhand.runs.run import COMPUTING_TIME, TIME_LIMIT, Run
from farhand.runs.scenario import Scenario, load_scenario
from farhand.runs.summary import RunSummary, summarise
from farhand.runs.why import INTERRUPTED, unfinished

if TYPE_CHECKING:
    from typing_extensions import Unpack

START_NS = 1_000_000_000
MOST_REST = 3.0
"""After a run a robot may take so long to come to rest (s)."""

Trajectory = list[tuple[float, float, float, float, float]]


@dataclass
class SimulationResult:
    """Attributes:
    summary: see RunSummary.
    trajectory: (t, x, y, z, clearance) at 50 Hz at most; t in s from the robot's start, m.
    digest: SHA-256 over every message that left or reached the operator, in order.
    network: the emulator's statistics.
    reports: of every tick, where asked for.
    silences: (from, to) of times without an answer of the robot, s since the first motion command.
    guarding: (from, to) of times in which the guard on the robot acted, likewise.
    fault: what the operator's program raised, which ended the run, in words; empty: nothing.
    recording_trouble: what the recording lacks, in words; empty: nothing.
    """

    summary: RunSummary
    trajectory: Trajectory
    digest: str
    network: NetemResult
    reports: list[ControlReport] = field(default_factory=list)
    silences: list[Span] = field(default_factory=list)
    guarding: list[Span] = field(default_factory=list)
    fault: str = ""
    recording_trouble: str = ""


class Options(TypedDict, total=False):
    """What a simulation keeps, and what takes the place of the scenario's own.

    Attributes:
        keep_reports: keep every ControlReport.
        record_to: file for a recording that can be replayed.
        digest: hash every message.
        stop: asked after every tick of the operator; the run ends, as interrupted, once it is true.
        rests: asked after the run, while the robot does what is still under way and the operator's program is gone,
            until it is true with nothing more on its way to it, or MOST_REST is over; nothing of that is in the result.
        controller, robot: in place of the scenario's; fresh, as they keep state; the caller closes the robot.
        listener: given the report of every tick of the operator.
        tap: given every packet that the robot sends, as it leaves, and every one that reaches the operator.
    """

    keep_reports: bool
    record_to: Path | None
    digest: bool
    stop: Callable[[], bool]
    rests: Callable[[], bool]
    controller: Controller | None
    robot: Robot | None
    listener: Callable[[ControlReport], None]
    tap: Tap


def simulate(  # noqa: PLR0913 (the friendly front door)
    scenario: Scenario | str,
    *,
    network: str | None = None,
    uplink: str | None = None,
    downlink: str | None = None,
    seed: int = 0,
    time_limit: float = TIME_LIMIT,
    computing_time: float = COMPUTING_TIME,
    timeline: str | None = None,
    **options: "Unpack[Options]",
) -> SimulationResult:
    """Run one task in virtual time.

    Args:
        scenario: what to do: a Scenario, or the name of a built-in one or of a TOML file.
        network: SPEC of both directions; None takes the scenario's, and `none` where it has none.
        uplink, downlink: SPECs of one direction, where it differs.
        seed: of every random stream.
        time_limit: of the task, from the first motion command (s).
        computing_time: of a control tick (s).
        timeline: TOML file of changes of the network at given times.
        options: `keep_reports=True` keeps every ControlReport, `record_to=PATH` writes a recording that can be
            replayed, `digest=True` hashes every message; `stop=` is asked whether to end at once;
            `controller=` and `robot=` stand in for the scenario's: fresh ones, as they keep state, and the caller
            closes the robot.

    Raises:
        InputError: a SPEC, a file, a number or the robot's start makes no sense.
        TypeError: an argument that there is not.
    """
    scenario = load_scenario(scenario) if isinstance(scenario, str) else scenario
    run = msgspec.structs.replace(
        Run.over(scenario, network, uplink=uplink, downlink=downlink, seed=seed),
        time_limit=time_limit,
        computing_time=(computing_time,),
        timeline=timeline,
    )
    return simulate_run(run, **options)


def simulate_run(run: Run, **options: "Unpack[Options]") -> SimulationResult:
    """Do a run in virtual time; for the options, see Options. Raises TypeError for one that there is not."""
    unknown = set(options) - set(Options.__annotations__)
    if unknown:
        known = ", ".join(Options.__annotations__)
        raise TypeError(f"simulate() has no argument {sorted(unknown)[0]!r}; its options are {known}")
    with ExitStack() as closing:
        world = _World(run, options, closing)
        result = world.run()
        if "rests" in options:
            world.go_on_without_operator(options["rests"])
    result.recording_trouble = world.recording_trouble()
    return result


class _World:
    """The three nodes, joined; `run` runs them to the end.

    Args:
        run: what to do.
        options: see Options.
        closing: takes what is to be closed in the end.
    """

    def __init__(self, run: Run, options: Options, closing: ExitStack) -> None:
        self._run = run
        self._stop = options.get("stop", lambda: False)
        self._executor = VirtualExecutor(START_NS)
        self._hasher = hashlib.sha256()
        self._tally, self._reports = Tally(), list[ControlReport]()
        operator_end, netem_operator_end = self._executor.wire()
        netem_robot_end, robot_end = self._executor.wire()
        if options.get("digest", False):
            hash_traffic(operator_end, self._hasher.update)
        if "tap" in options:
            listen(operator_end, robot_end, options["tap"])
        self._robot = self._make_robot(robot_end, options.get("robot"), closing)
        session = session_of(run.seed, "operator")
        self._recorder = _recorder(options.get("record_to"), run, session)
        logs = [_FateLog(self, self._recorder)] if self._recorder is not None else []
        self.netem = make_netem(netem_operator_end, netem_robot_end, run, logs)
        self._operator = self._make_operator(operator_end, session, options, closing)
        self._add_nodes()
        for link in (netem_operator_end, netem_robot_end):
            self._executor.wake_on_message(self.netem, link)

    def run(self) -> SimulationResult:
        """Until all is done, or the time is up."""
        run, operator = self._run, self._operator
        end_ns = _run(self._executor, operator, to_ns(run.time_limit), self._stop)
        self.netem.check_conservation()
        self.netem.tell_rest()
        results = RunResults(
            operator=self._operator_result(end_ns),
            netem=self.netem.statistics(),
            robot=self._robot.summary(),
        )
        why = ""
        if self._stop() and not operator.finished:
            why = INTERRUPTED
        elif not operator.finished:
            why = unfinished(self._tally.last, run)
            if not operator.fault and not operator.device.over:
                why = f"not finished within {run.time_limit:g} s: {why}"
        summary = summarise(run, results, real_time=False, why=why)
        assert results.netem is not None
        return SimulationResult(
            summary,
            list(self._robot.trajectory),
            self._hasher.hexdigest(),
            results.netem,
            self._reports,
            results.operator.silences if results.operator is not None else [],
            results.operator.guarding if results.operator is not None else [],
            operator.fault,
        )

    def go_on_without_operator(self, rests: Callable[[], bool]) -> None:
        """What is under way still moves the robot, until `rests()`."""
        executor = self._executor
        executor.remove(self._operator)
        executor.run_until(
            executor.clock.now_ns() + to_ns(MOST_REST),
            lambda: rests() and not self.netem.uplink_queued,
            Priority.ROBOT,
        )

    def recording_trouble(self) -> str:
        """What the recording lacks, once it is closed."""
        recorder = self._recorder
        if recorder is None:
            return ""
        if recorder.missing:
            return f"{recorder.missing} ticks are missing: {recorder.trouble}"
        return recorder.trouble

    def _make_robot(self, link: MemoryLink, robot: Robot | None, closing: ExitStack) -> RobotNode:
        scenario = self._run.scenario
        if robot is None:
            if ROBOTS.get(scenario.robot.kind, "robot.kind").is_real:
                raise InputError(
                    f"robot.kind {scenario.robot.kind!r}: virtual time cannot drive a real robot; simulate kind 'arm'"
                )
            robot = make_robot(scenario)
            closing.callback(_close, robot)  # a world of PyBullet is 30 MB that stay otherwise
        return make_robot_node(
            scenario, link, scenario.robot.kind, session_of(self._run.seed, "robot"), robot
        )

    def _make_operator(
        self, link: MemoryLink, session: int, options: Options, closing: ExitStack
    ) -> OperatorNode:
        scenario, name = self._run.scenario, self._run.scenario.robot.kind
        controller = options.get("controller")
        if controller is None:
            controller = make_controller(scenario.controller)
        prepare(controller)
        self._solver = controller.settings.solver
        operator = make_operator(scenario, link, OperatorIdentity(name, session, OPERATOR_NAME), controller)
        if self._recorder is not None:
            closing.callback(self._recorder.close)
        operator.recorder = self._recorder
        operator.listeners.append(self._tally.add)
        if options.get("keep_reports", False):
            operator.listeners.append(self._reports.append)
        if "listener" in options:
            operator.listeners.append(options["listener"])
        return operator

    def _add_nodes(self) -> None:
        executor = self._executor
        executor.add(self._robot, Priority.ROBOT)
        executor.add(self.netem, Priority.NETEM)
        executor.add(self._operator, Priority.OPERATOR, _cost(self._run))

    def _operator_result(self, end_ns: int) -> OperatorResult:
        operator, tally = self._operator, self._tally
        since_ns = operator.driving_since_ns
        rtt_mean, rtt_std = operator.round_trip.overall()
        response = operator.response  # an estimate that takes its time
        counted = msgspec.structs.replace(
            tally.counts(),
            duration=to_seconds(end_ns - since_ns) if since_ns is not None else 0.0,
            rtt_mean=rtt_mean,
            rtt_std=rtt_std,
            overruns=tally.last.overruns if tally.last is not None else 0,
            lag=response.lag,
            acceleration=response.acceleration,
        )
        return OperatorResult(
            **msgspec.structs.asdict(counted),
            finished=operator.finished,
            silences=tally.silences(since_ns or 0),
            guarding=tally.guarding(since_ns or 0),
            solver=self._solver,
            last_report=tally.last,
        )


class _FateLog:
    """What became of every message, into the recording."""

    def __init__(self, world: _World, recorder: RunRecorder) -> None:
        self._world, self._recorder = world, recorder

    def record(self, fate: Fate) -> None:
        """See MessageLog."""
        self._recorder.fate(fate, self._world.netem.origin_ns)


def _run(executor: VirtualExecutor, operator: OperatorNode, limit_ns: int, stop: Callable[[], bool]) -> int:
    """Until `stop()`, or finished, or the limit after the first motion command (after the start, if there is none)."""
    start_ns = executor.clock.now_ns()
    executor.run_until(
        start_ns + limit_ns,
        lambda: operator.driving_since_ns is not None or bool(operator.fault) or stop(),
        Priority.OPERATOR,
    )
    if operator.driving_since_ns is not None:
        executor.run_until(
            operator.driving_since_ns + limit_ns,
            lambda: operator.finished or operator.device.over or bool(operator.fault) or stop(),
            Priority.OPERATOR,
        )
    return executor.clock.now_ns()


def _cost(run: Run) -> Callable[[], int]:
    """The modelled duration of each tick (ns)."""
    samples = [to_ns(sample) for sample in run.computing_time]
    if len(samples) == 1:
        constant = samples[0]
        return lambda: constant
    draw = stream(run.seed, "computing-time")
    return lambda: samples[int(draw.integers(len(samples)))]


def _recorder(path: Path | None, run: Run, session: int) -> RunRecorder | None:
    if path is None:
        return None
    info = RunInfo(
        scenario=run.table(),
        robot=run.scenario.robot.kind,
        session=session,
        seed=run.seed,
        versions=versions(),
        solver=run.scenario.controller.solver,
        git=source_state(),
    )
    return RunRecorder(path, info, views_of(info))


def _close(robot: Robot) -> None:
    """Give a robot back; what it gets wrong there must not cost the result."""
    with suppress(Exception):
        robot.close()
