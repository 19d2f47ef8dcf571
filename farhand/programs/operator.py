"""The program `farhand operator`: its sessions and links, the node in its loop, its results at the end."""

import threading
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import zenoh

from farhand.common.errors import InputError
from farhand.common.link.link import Link, Packet
from farhand.common.link.zenoh_link import ZenohLink, open_session
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.keys import (
    camera_key,
    check_robot_name,
    description_key,
    scene_key,
    state_key,
    steering_key,
)
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Scene
from farhand.common.process.called import called
from farhand.common.process.outputs import survive
from farhand.common.process.security import Access, guard, local_only, secure
from farhand.common.process.signals import PeerWatch, say, stop_event_on_signals
from farhand.common.process.teller import Teller
from farhand.common.recording.records import RunInfo
from farhand.common.result_file import write_result
from farhand.common.shapes import hull
from farhand.common.timing.clock import SystemClock, stopwatch_seconds
from farhand.common.timing.slot import Slot
from farhand.common.trust.tls import TlsFolder
from farhand.common.trust.zenoh_log import tell_refusals
from farhand.operator_side.accounts.result import OperatorResult, Sample, Tally, sample_of
from farhand.operator_side.accounts.tick_history import TickHistory
from farhand.operator_side.control.controller import Controller
from farhand.operator_side.control.registry import make_controller
from farhand.operator_side.devices.sources import SOURCES
from farhand.operator_side.main import Mirror, MirroredLink, OperatorOutcome, ReportPublisher, run_operator
from farhand.operator_side.operator_node import OperatorIdentity, OperatorNode
from farhand.operator_side.steering.device import SteeringDevice
from farhand.operator_side.steering.hand.remote import Remote
from farhand.operator_side.steering.registry import make_device
from farhand.programs.compiling import prepare_aloud
from farhand.programs.series import Series
from farhand.programs.sessions import random_session
from farhand.programs.wiring import make_operator, source_state, versions
from farhand.runs.difference import difference, scene_difference
from farhand.runs.scenario import Scenario, scenario_to_table
from farhand.runs.words.scene import scene_words
from farhand.site.acknowledge import AcknowledgeServer
from farhand.site.estop import EstopServer
from farhand.site.handover import HandoverServer
from farhand.site.operator_name import operator_name
from farhand.site.scene import SceneServer
from farhand.site.tick_server import TickServer


class Course:
    """A listener that keeps what a run's results need, in bounded memory, and has changes of reason said.

    It says, too, where the robot is another one than the scenario says, once a description.

    Args:
        node: whose reports it hears.
        scenario: the operator's own.
        tell: takes a line for people; must not wait.
    """

    def __init__(self, node: OperatorNode, scenario: Scenario, tell: Callable[[str], None]) -> None:
        self.tally = Tally()
        self.series: Series[Sample] = Series()
        self._node, self._tell = node, tell
        self._scenario = scenario
        self._said = self._held = ""
        self._differs: set[str] = set()
        self._robot: RobotDescription | None = None
        self._scene: Scene | None = None

    def __call__(self, report: ControlReport) -> None:
        """Hear of one tick."""
        self.tally.add(report)
        self.series.add(sample_of(report, self._node.driving_since_ns or report.t_sent_ns))
        if report.stop_reason != self._said:
            self._said = report.stop_reason
            self._tell(self._said or "driving")
        if report.held_by != self._held:
            self._held = report.held_by
            self._tell(f"no progress: held by {self._held}" if self._held else "makes progress again")
        self._compare()

    def _compare(self) -> None:
        """Say, once, where description or scene differ from the scenario."""
        robot, scene = self._node.robot, self._node.scene
        if robot is not None and robot is not self._robot:
            self._robot = robot
            self._tell_new(difference(robot, self._scenario))
        if scene is not None and scene is not self._scene:
            changed, self._scene = scene_words(self._scene, scene), scene
            if changed:
                self._tell(changed)
            elif not scene.changes:  # after a change it differs from the scenario by intent
                self._tell_new(scene_difference(scene, self._scenario))

    def _tell_new(self, line: str) -> None:
        if line and line not in self._differs:
            self._differs.add(line)
            self._tell(line)


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatorOptions:
    """What `farhand operator` is asked for beside the scenario and how it meets the others.

    Attributes:
        robot: name of the robot.
        name: what others call this operator; empty: the certificate's name, else USER@HOST.
        seed: of the run, for its recording; the operator's side draws nothing.
        time_limit: after the first motion command (s); None: no limit.
        report: endpoint of this host for reports and handovers; empty: none.
        result: JSON file for what happened; None: none.
        realtime: ask for SCHED_FIFO.
    """

    robot: str
    name: str = ""
    seed: int = 0
    time_limit: float | None = None
    report: str = ""
    result: Path | None = None
    realtime: bool = True


def operator_program(scenario: Scenario, access: Access, options: OperatorOptions) -> int:
    """Run the operator's side; returns 0 if the task was finished, else 1. Raises InputError."""
    robot = check_robot_name(options.robot)
    mode = access.mode
    folder = secure(access, lambda line: say("operator", line), "operator", robot)
    called = operator_name(options.name, folder)
    device = _device(scenario, options)
    stop_event = stop_event_on_signals()
    clock = SystemClock()
    with ExitStack() as closing:
        teller = Teller("operator")
        closing.callback(teller.close)
        if folder is not None:
            tell_refusals(teller.say)
        report_session = (
            open_session(listen=[local_only(options.report, "--report")]) if options.report else None
        )
        controller = make_controller(scenario.controller)
        prepare_aloud(controller, teller.say)  # compiled before anything is connected
        hull.prepare()
        if controller.solver_notice:
            teller.say(controller.solver_notice)
        extra = folder.settings("operator") if folder else ()
        heard = threading.Event()
        session = open_session(access.connect, access.listen, mode=mode, extra=extra)
        keys = [state_key(robot), scene_key(robot), description_key(robot)]
        link = ZenohLink(session, keys, clock, heard.set)
        closing.callback(link.close)
        guard(session, folder, robot, "operator", teller.say)
        teller.say(f"{called}: drives robot {robot!r} at {access.where}; Ctrl-C ends it")
        _invite(scenario.steering.kind, options, teller.say)
        identity = OperatorIdentity(robot, random_session(), called)
        report_link: ZenohLink | None = None
        if report_session is not None:
            report_link = _report_link(report_session, robot, device, clock)
            closing.callback(report_link.close)
            pictures = _relay(session, report_link, robot, clock)
            closing.callback(pictures.undeclare)
        node = make_operator(
            scenario, _mirrored(link, report_link, robot), identity, controller, stopwatch_seconds, device
        )
        if node.device.acknowledges_itself:
            kind = scenario.steering.kind
            teller.say(f"steering {kind!r} acknowledges stops by itself, but never an emergency stop")
        course = Course(node, scenario, teller.say)
        node.listeners.append(course)
        slot = Slot()
        handover = HandoverServer(node, slot, clock, report_session, robot, options.report, teller.say)
        closing.callback(handover.close)
        if report_session is not None and report_link is not None:
            stopper = EstopServer(node, slot, clock, report_session, robot, teller.say)
            closing.callback(stopper.close)
            clearer = AcknowledgeServer(node, slot, clock, report_session, robot, teller.say)
            closing.callback(clearer.close)
            changer = SceneServer(node, slot, clock, report_session, robot, teller.say, link)
            closing.callback(changer.close)
            node.recorder = history = TickHistory()
            info = _run_info(options, scenario, identity, controller.settings.solver, clock.epoch_ns())
            ticks = TickServer(history, info, report_session, clock.now_ns)
            closing.callback(ticks.close)
            limit = scenario.controller.d_min

            def beside(now_ns: int) -> dict[str, Any]:
                return {"connected": not watch.alone, "limit": limit, "recording": ticks.recording(now_ns)}

            node.listeners.append(ReportPublisher(report_link, robot, beside))
        unheard = _unheard(robot, folder, access.router)
        watch = PeerWatch(
            "operator", access.where, link.connected, stop_event, heard.is_set, unheard, link.losses
        )
        outcome = run_operator(
            node, clock, stop_event, time_limit=options.time_limit, slot=slot, realtime=options.realtime
        )
    if options.result is not None:
        path, result = options.result, _result(node, outcome, course, controller)
        survive(f"--result {path}", lambda: write_result(result, path), lambda line: say("operator", line))
    say("operator", "finished" if outcome.finished else "ended before the last target")
    return 0 if outcome.finished else 1


def _device(scenario: Scenario, options: OperatorOptions) -> SteeringDevice:
    """What steers; raises InputError where it is steered from other programs and could not hear them."""
    device = make_device(scenario.steering)
    if isinstance(device, Remote) and not options.report:
        kind = scenario.steering.kind
        raise InputError(f"--steer {kind}: needs --report ENDPOINT, where consoles and gamepads are heard")
    return device


def _invite(kind: str, options: OperatorOptions, say: Callable[[str], None]) -> None:
    """Say how a hand comes to the device that is to steer, if it is one of this host."""
    if kind in SOURCES:
        hand = f"steer {kind} --connect {options.report} --robot {options.robot}"
        say(f"waits for a hand: `{called()} {hand}`")


def _report_link(session: zenoh.Session, robot: str, device: SteeringDevice, clock: SystemClock) -> ZenohLink:
    """The link to who is on this side of the network; a device that is steered from there hears it."""
    remote = isinstance(device, Remote)
    link = ZenohLink(session, [steering_key(robot)] if remote else [], clock)
    if isinstance(device, Remote):
        device.listen(link)
    return link


def _relay(
    session: zenoh.Session, reports: ZenohLink, robot: str, clock: SystemClock
) -> "zenoh.Subscriber[None]":
    """Pass pictures on to whoever shows them, past the operator's node, which never sees one."""
    mirror, key = Mirror(reports, robot), camera_key(robot)

    def relay(sample: zenoh.Sample) -> None:
        if sample.kind == zenoh.SampleKind.PUT:
            mirror(Packet(key, sample.payload.to_bytes(), clock.now_ns()))

    return session.declare_subscriber(key, relay)


def _mirrored(link: ZenohLink, reports: ZenohLink | None, robot: str) -> Link:
    """The link to the robot, both directions of which are seen on the reports' session too, if there is one."""
    if reports is None:
        return link
    mirrored = MirroredLink(link, reports, robot)
    link.mirror = mirrored.mirror
    return mirrored


def _run_info(
    options: OperatorOptions, scenario: Scenario, identity: OperatorIdentity, solver: str, epoch_ns: int
) -> RunInfo:
    return RunInfo(
        scenario=scenario_to_table(scenario),
        robot=identity.robot,
        session=identity.session,
        seed=options.seed,
        versions=versions(),
        solver=solver,
        operator=identity.name,
        clock="real",
        epoch_ns=epoch_ns,
        git=source_state(),
    )


def _result(
    node: OperatorNode, outcome: OperatorOutcome, course: Course, controller: Controller
) -> OperatorResult:
    rtt_mean, rtt_std = node.round_trip.overall()
    tally = course.tally
    counted = msgspec.structs.replace(
        tally.counts(),
        duration=outcome.duration,
        rtt_mean=rtt_mean,
        rtt_std=rtt_std,
        overruns=outcome.overruns,
        lateness_p99=outcome.lateness_p99,
        lag=node.response.lag,
        acceleration=node.response.acceleration,
    )
    return OperatorResult(
        **msgspec.structs.asdict(counted),
        finished=outcome.finished,
        has_realtime_priority=outcome.has_realtime_priority,
        solver=controller.settings.solver,
        notice=controller.solver_notice,
        series=course.series.samples(),
        silences=tally.silences(node.driving_since_ns or 0),
        guarding=tally.guarding(node.driving_since_ns or 0),
        last_report=tally.last,
    )


def _unheard(name: str, folder: TlsFolder | None, router: bool) -> str:
    """What to say when a connection is there, and nothing comes over it."""
    line = f"connected, but nothing comes from robot {name!r}: it is not running, or has another name"
    if folder is not None:
        line += f", or certificate {folder.own.name!r} is not among the members/ there"
    if not router:
        line += ", or behind a Zenoh router, which needs --router on both sides"
    return line
