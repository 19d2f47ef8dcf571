"""The programs `farhand operator` and `farhand robot`: sessions, links, the node, results at the end.

`farhand netem` is in netem_commands.py.
"""

import os
import secrets
import threading
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

from farhand.common.errors import EndpointError, InputError
from farhand.common.link.zenoh_link import ZenohLink, open_session
from farhand.common.messages.keys import check_robot_name, command_key, description_key, scene_key, state_key
from farhand.common.messages.report import ControlReport
from farhand.common.process.security import guard, local_only, secure
from farhand.common.process.signals import PeerWatch, say, stop_event_on_signals
from farhand.common.process.systemd import tell_systemd
from farhand.common.recording.recorder import RunInfo, RunRecorder
from farhand.common.result_file import write_result
from farhand.common.timing.clock import SystemClock, processor_seconds
from farhand.common.trust.zenoh_log import tell_refusals
from farhand.operator_side.control.registry import make_controller
from farhand.operator_side.main import run_operator
from farhand.operator_side.operator_node import OperatorIdentity
from farhand.operator_side.result import OperatorResult, Sample, Tally, sample_of
from farhand.programs.wiring import make_operator, versions
from farhand.robot_side.main import run_robot
from farhand.runs.scenario import Scenario, scenario_to_table
from farhand.site.handover import HandoverServer
from farhand.site.operator_name import operator_name


def random_session() -> int:
    """A session for one start of a program; never 0."""
    return secrets.randbelow((1 << 62) - 1) + 1


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
    folder = secure(tls, insecure, connect, listen, lambda line: say("operator", line), "operator", name)
    called = operator_name(operator, folder)
    if folder is not None:
        tell_refusals(lambda line: say("operator", line))
    stop_event = stop_event_on_signals()
    clock = SystemClock()
    session = random_session()
    report_session = open_session(listen=[local_only(report, "--report")]) if report else None
    report_link = ZenohLink(report_session, [], clock) if report_session is not None else None
    where = ", ".join([*connect, *listen])
    tally = Tally()
    series: list[Sample] = []
    with ExitStack() as closing:
        if report_link is not None:
            closing.callback(report_link.close)
        controller = make_controller(scenario.controller)
        controller.prepare()  # compiled before anything is connected, so that nothing compiles in a run
        notice = getattr(controller, "solver_notice", "")
        if notice:
            say("operator", notice)
        solver = controller.settings.solver
        link_session = open_session(
            connect, listen, mode=_mode(router, listen), extra=folder.settings("operator") if folder else ()
        )
        heard = threading.Event()
        link = ZenohLink(
            link_session, [state_key(name), scene_key(name), description_key(name)], clock, heard.set
        )
        closing.callback(link.close)
        guard(link_session, folder, name, "operator", lambda line: say("operator", line))
        node = make_operator(
            scenario, link, OperatorIdentity(name, session, called), controller, processor_seconds
        )
        handover = HandoverServer(node, report_session, name, report or "")
        unheard = f"connected, but nothing comes from robot {name!r}: it is not running, or has another name"
        if folder is not None:
            unheard += f", or certificate {folder.own.name!r} is not among the members/ there"
        if not router:
            unheard += ", or behind a Zenoh router, which needs --router on both sides"
        PeerWatch("operator", where, link.connected, stop_event, heard.is_set, unheard)
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
        said = ""

        def watch(seen: ControlReport) -> None:
            nonlocal said
            tally.add(seen)
            series.append(sample_of(seen, node.driving_since_ns or seen.t_sent_ns))
            handover.serve(seen.t_sent_ns)
            if seen.stop_reason != said:
                said = seen.stop_reason
                say("operator", said or "driving")

        outcome = run_operator(
            node,
            name,
            clock,
            stop_event,
            report_link=report_link,
            time_limit=time_limit,
            watch=watch,
            realtime=realtime,
        )
    rtt_mean, rtt_std = node.round_trip.overall()
    if result is not None:
        found = OperatorResult(
            finished=outcome.finished,
            duration=outcome.duration,
            rtt_mean=rtt_mean,
            rtt_std=rtt_std,
            ticks=tally.ticks,
            interventions=tally.interventions,
            infeasible=tally.infeasible,
            overruns=outcome.overruns,
            lateness_p99=outcome.lateness_p99,
            has_realtime_priority=outcome.has_realtime_priority,
            solver=solver,
            notice=notice,
            series=series,
            last_report=tally.last,
        )
        write_result(found, result)
    say("operator", "finished" if outcome.finished else "ended before the last target")
    return 0 if outcome.finished else 1


def robot_program(
    scenario: Scenario,
    *,
    name: str,
    connect: Sequence[str],
    listen: Sequence[str],
    result: Path | None,
    realtime: bool = True,
    tls: str = "",
    insecure: bool = False,
    router: bool = False,
) -> int:
    """Run the robot's side until it is told to end."""
    check_robot_name(name)
    folder = secure(tls, insecure, connect, listen, lambda line: say("robot", line), "robot", name)
    if folder is not None:
        tell_refusals(lambda line: say("robot", line))
    stop_event = stop_event_on_signals()
    clock = SystemClock()
    extra = folder.settings("robot") if folder else ()
    link = ZenohLink(
        open_session(connect, listen, mode=_mode(router, listen), extra=extra), [command_key(name)], clock
    )
    try:
        guard(link.session, folder, name, "robot", lambda line: say("robot", line))
        PeerWatch("robot", ", ".join([*connect, *listen]), link.connected, stop_event)
        watched = tell_systemd(link, stop_event)
        run_robot(
            scenario, name, watched, clock, stop_event, result, realtime, lambda line: say("robot", line)
        )
    finally:
        link.close()
    return 0


def _mode(router: bool, listen: Sequence[str]) -> str:
    """The Zenoh mode of a program's session; raises EndpointError."""
    if router and listen:
        raise EndpointError(
            f"--listen {listen[0]}: a router's client only connects; leave --listen or --router out"
        )
    return "client" if router else "peer"


def check_writable(path: Path | None, option: str) -> None:
    """Raise InputError unless a file can be written there."""
    if path is None:
        return
    folder = path.resolve().parent
    if not folder.is_dir():
        raise InputError(f"{option} {path}: there is no folder {folder}")
    if path.is_dir():
        raise InputError(f"{option} {path}: is a folder; expected a file")
    if not os.access(path if path.exists() else folder, os.W_OK):
        raise InputError(f"{option} {path}: cannot be written: permission denied")
