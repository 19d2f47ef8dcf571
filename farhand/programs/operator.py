"""The program `farhand operator`: its sessions and links, the node in its loop, its results at the end."""

import threading
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path

from farhand.common.link.zenoh_link import ZenohLink, open_session
from farhand.common.messages.keys import check_robot_name, description_key, scene_key, state_key
from farhand.common.messages.report import ControlReport
from farhand.common.process.security import guard, local_only, secure
from farhand.common.process.signals import PeerWatch, say, stop_event_on_signals
from farhand.common.process.teller import Teller
from farhand.common.recording.records import RunInfo
from farhand.common.recording.writer import RunRecorder
from farhand.common.result_file import write_result
from farhand.common.timing.clock import SystemClock, processor_seconds
from farhand.common.timing.slot import Slot
from farhand.common.trust.tls import TlsFolder
from farhand.common.trust.zenoh_log import tell_refusals
from farhand.operator_side.control.registry import make_controller
from farhand.operator_side.main import ReportPublisher, run_operator
from farhand.operator_side.operator_node import OperatorIdentity, OperatorNode
from farhand.operator_side.result import OperatorResult, Sample, Tally, sample_of
from farhand.programs.series import Series
from farhand.programs.sessions import random_session, session_mode
from farhand.programs.wiring import make_operator, versions
from farhand.runs.scenario import Scenario, scenario_to_table
from farhand.site.handover import HandoverServer
from farhand.site.operator_name import operator_name


class Course:
    """A listener that keeps what a run's results need, in bounded memory, and has changes of reason said.

    Args:
        node: whose reports it hears.
        tell: takes a line for people; must not wait.
    """

    def __init__(self, node: OperatorNode, tell: Callable[[str], None]) -> None:
        self.tally = Tally()
        self.series: Series[Sample] = Series()
        self._node, self._tell = node, tell
        self._said = ""

    def __call__(self, report: ControlReport) -> None:
        """Hear of one tick."""
        self.tally.add(report)
        self.series.add(sample_of(report, self._node.driving_since_ns or report.t_sent_ns))
        if report.stop_reason != self._said:
            self._said = report.stop_reason
            self._tell(self._said or "driving")


def operator_program(
    scenario: Scenario,
    *,
    name: str,
    connect: Sequence[str],
    listen: Sequence[str],
    report: str | None,
    seed: int,
    time_limit: float | None,
    record: Path | None,
    result: Path | None,
    realtime: bool = True,
    tls: str = "",
    insecure: bool = False,
    router: bool = False,
    operator: str = "",
) -> int:
    """Run the operator's side; returns 0 if the task was finished, else 1."""
    check_robot_name(name)
    mode = session_mode(router, listen)
    folder = secure(tls, insecure, connect, listen, lambda line: say("operator", line), "operator", name)
    called = operator_name(operator, folder)
    stop_event = stop_event_on_signals()
    clock, session = SystemClock(), random_session()
    with ExitStack() as closing:
        teller = Teller("operator")
        closing.callback(teller.close)
        if folder is not None:
            tell_refusals(teller.say)
        report_session = open_session(listen=[local_only(report, "--report")]) if report else None
        controller = make_controller(scenario.controller)
        controller.prepare()  # compiled before anything is connected, so that nothing compiles in a run
        notice, solver = controller.solver_notice, controller.settings.solver
        if notice:
            teller.say(notice)
        heard = threading.Event()
        extra = folder.settings("operator") if folder else ()
        link_session = open_session(connect, listen, mode=mode, extra=extra)
        keys = [state_key(name), scene_key(name), description_key(name)]
        link = ZenohLink(link_session, keys, clock, heard.set)
        closing.callback(link.close)
        guard(link_session, folder, name, "operator", teller.say)
        identity = OperatorIdentity(name, session, called)
        node = make_operator(scenario, link, identity, controller, processor_seconds)
        course = Course(node, teller.say)
        node.listeners.append(course)
        if report_session is not None:
            report_link = ZenohLink(report_session, [], clock)
            closing.callback(report_link.close)
            node.listeners.append(ReportPublisher(report_link, name))
        slot = Slot()
        handover = HandoverServer(node, slot, clock, report_session, name, report or "", teller.say)
        closing.callback(handover.close)
        recorder = None
        if record is not None:
            info = RunInfo(
                scenario=scenario_to_table(scenario),
                robot=name,
                session=session,
                seed=seed,
                versions=versions(),
                solver=solver,
                operator=called,
            )
            recorder = RunRecorder(record, info)
            closing.callback(recorder.close)
            node.recorder = recorder

        def troubles() -> dict[str, str]:
            return link.losses() | (recorder.troubles() if recorder is not None else {})

        where = ", ".join([*connect, *listen])
        PeerWatch(
            "operator",
            where,
            link.connected,
            stop_event,
            heard.is_set,
            _unheard(name, folder, router),
            troubles,
        )
        outcome = run_operator(node, clock, stop_event, time_limit=time_limit, slot=slot, realtime=realtime)
    if recorder is not None and recorder.trouble:
        say("operator", f"--record {record}: {recorder.missing} ticks are missing: {recorder.trouble}")
    rtt_mean, rtt_std = node.round_trip.overall()
    if result is not None:
        found = OperatorResult(
            finished=outcome.finished,
            duration=outcome.duration,
            rtt_mean=rtt_mean,
            rtt_std=rtt_std,
            ticks=course.tally.ticks,
            interventions=course.tally.interventions,
            infeasible=course.tally.infeasible,
            overruns=outcome.overruns,
            lateness_p99=outcome.lateness_p99,
            has_realtime_priority=outcome.has_realtime_priority,
            solver=solver,
            notice=notice,
            series=course.series.samples(),
            last_report=course.tally.last,
        )
        write_result(found, result)
    say("operator", "finished" if outcome.finished else "ended before the last target")
    return 0 if outcome.finished else 1


def _unheard(name: str, folder: TlsFolder | None, router: bool) -> str:
    """What to say when a connection is there, and nothing comes over it."""
    line = f"connected, but nothing comes from robot {name!r}: it is not running, or has another name"
    if folder is not None:
        line += f", or certificate {folder.own.name!r} is not among the members/ there"
    if not router:
        line += ", or behind a Zenoh router, which needs --router on both sides"
    return line
