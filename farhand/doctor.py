"""`farhand doctor`: what is wrong on the path to a robot, and what to do about it.

It asks with the program's own certificate, from the operator's host, and disturbs nobody: it sends no
command. Round trip and loss are measured by the `about` question, which goes the way that commands go.
"""

import json
import threading
from dataclasses import asdict, dataclass
from typing import Any

import zenoh
from rich.console import Console
from rich.table import Table

from common.clock import SystemClock, to_ns
from common.codec import Decoder
from common.errors import CertificateError
from common.keys import about_key, state_key
from common.messages import RobotState
from common.presence import about
from common.scenario import Scenario
from common.tls import TlsFolder, load_folder
from common.zenoh_link import check_endpoint, open_session
from farhand.doctor_network import Finding, probe_tcp, probe_tls
from farhand.robots import MEET_TIME, alive, meet
from farhand.security import tool_place

QUESTION_PERIOD = 0.05
ANSWER_TIME = 3.0
OPEN_TIME_MS = 3000


@dataclass(frozen=True, slots=True)
class Answers:
    """What the questions brought: how many were asked, round trips (s, sorted), the newest facts."""

    asked: int
    round_trips: tuple[float, ...]
    facts: dict[str, Any]


def run_doctor(endpoint: str, robot: str, tls: str, scenario: Scenario, count: int, as_json: bool) -> int:
    """Check everything and print it; returns 1 if anything is in the way, else 0.

    Args:
        endpoint: where the operator's program connects to.
        robot: its name.
        tls: certificate folder; empty: none.
        scenario: what the path must be good enough for.
        count: questions that measure the path.
        as_json: print JSON instead of a table.
    """
    findings = examine(check_endpoint(endpoint), robot, tls, scenario, count)
    if as_json:
        print(json.dumps([asdict(finding) for finding in findings]))
    else:
        table = Table("", "what", "found", "what to do", title=f"the path to {robot}", title_justify="left")
        for finding in findings:
            table.add_row(finding.level, finding.what, finding.found, finding.remedy)
        Console().print(table)
    return 1 if any(finding.level == "bad" for finding in findings) else 0


def examine(endpoint: str, robot: str, tls: str, scenario: Scenario, count: int) -> list[Finding]:
    """The findings, in order; what cannot be looked at for an earlier fault is left out."""
    findings: list[Finding] = []
    folder: TlsFolder | None = None
    if tls:
        try:
            folder = load_folder(tls)
        except CertificateError as error:
            return [Finding("bad", "certificate", str(error), "see docs/two-hosts.md, Certificates")]
        findings += _certificate(folder, robot)
    elif endpoint.startswith("tls/"):
        return [Finding("bad", "certificate", "none given", "give this program's folder with --tls DIR")]
    findings.append(_rights("this host", about("doctor")))
    findings.append(probe_tcp(endpoint))
    if findings[-1].level != "bad" and folder is not None:
        findings.append(probe_tls(endpoint, folder))
    if findings[-1].level == "bad":
        return findings
    extra = [*(folder.settings(tool_place(folder)) if folder else ())]
    extra.append(("transport/unicast/open_timeout", OPEN_TIME_MS))
    session = open_session([endpoint], extra=extra)
    try:
        return findings + _ask(session, endpoint, robot, scenario, count)
    finally:
        session.close()  # type: ignore[no-untyped-call]


def _ask(session: zenoh.Session, endpoint: str, robot: str, scenario: Scenario, count: int) -> list[Finding]:
    if not meet(session, MEET_TIME):
        remedy = "is it a farhand program? if it wants TLS, give tls/... and --tls DIR"
        return [Finding("bad", "Zenoh", f"{endpoint} answers, but not as a Zenoh peer", remedy)]
    present = alive(session)
    findings = [Finding("good", "emulator", "on the way" if "netem" in present else "none on the way")]
    if "robot" not in present.get(robot, set()):
        there = ", ".join(name for name in sorted(present) if name != "netem") or "no robot"
        remedy = "start `farhand robot`, or see --robot; with TLS look at the members/ on the way"
        return [*findings, Finding("bad", "robot", f"{robot!r} is not there; there is: {there}", remedy)]
    findings.append(Finding("good", "robot", "there"))
    decoder, states = Decoder(RobotState), [0]

    def receive(sample: zenoh.Sample) -> None:
        states[0] += decoder.decode(sample.payload.to_bytes()) is not None

    subscriber = session.declare_subscriber(state_key(robot), receive)
    answers = _measure(session, about_key(robot, "robot"), count)
    subscriber.undeclare()  # type: ignore[no-untyped-call]
    findings += _versions(answers.facts, decoder)
    findings += _path(answers, scenario)
    if answers.facts:
        findings.append(_rights("robot's host", answers.facts))
    if not states[0]:
        remedy = "with TLS, is this certificate named for the robot everywhere on the way?"
        findings.append(Finding("bad", "states", "none arrived", remedy))
    else:
        findings.append(Finding("good", "states", f"{states[0]} arrived"))
    return findings


def _measure(session: zenoh.Session, key: str, count: int) -> Answers:
    """Ask `count` times at 20 Hz and wait for the answers."""
    clock, done = SystemClock(), threading.Event()
    trips: list[float] = []
    facts: dict[str, Any] = {}

    def ask() -> None:
        asked_ns = clock.now_ns()

        def answered(reply: zenoh.Reply) -> None:
            if reply.ok is None:
                return
            trips.append((clock.now_ns() - asked_ns) * 1e-9)
            try:
                found = json.loads(reply.ok.payload.to_bytes())
            except ValueError:
                found = None
            if isinstance(found, dict):
                facts.update(found)
            if len(trips) >= count:
                done.set()

        session.get(key, answered, timeout=ANSWER_TIME)

    start_ns = clock.now_ns()
    for number in range(count):
        clock.sleep_until(start_ns + to_ns(number * QUESTION_PERIOD))
        ask()
    done.wait(ANSWER_TIME)
    return Answers(count, tuple(sorted(trips)), facts)


def _path(answers: Answers, scenario: Scenario) -> list[Finding]:
    trips, safety = answers.round_trips, scenario.safety
    if not trips:
        remedy = "is the link up both ways? an emulator with an outage? `farhand netem show`"
        return [Finding("bad", "round trip", f"none of {answers.asked} questions was answered", remedy)]
    middle, late = trips[len(trips) // 2], trips[min(len(trips) - 1, int(len(trips) * 0.99))]
    found = f"median {middle * 1e3:.1f} ms, 99th percentile {late * 1e3:.1f} ms"
    if late > safety.max_age:
        remedy = (
            f"the robot refuses commands built on a state older than {safety.max_age * 1e3:.0f} ms: "
            "mend the link, or drive slowly with a larger safety.max_age"
        )
        findings = [Finding("bad", "round trip", found, remedy)]
    else:
        findings = [Finding("good", "round trip", found)]
    lost = 1.0 - len(trips) / answers.asked
    found = f"{answers.asked - len(trips)} of {answers.asked} questions or answers"
    if lost == 0.0:
        return [*findings, Finding("good", "loss", found)]
    # Both ways share the loss; the robot holds when every command within its timeout is lost.
    one_way = 1.0 - (1.0 - lost) ** 0.5
    period = scenario.controller.period
    in_a_row = max(1, int(safety.command_timeout / period))
    holds = 60.0 / period * one_way**in_a_row * (1.0 - one_way)
    found += f"; about {holds:.2g} holds a minute from it"
    level = "bad" if holds > 1.0 else "note"
    remedy = "mend the link (radio, cable, congestion); TCP itself loses nothing, so look for an emulator"
    return [*findings, Finding(level, "loss", found, remedy)]


def _versions(facts: dict[str, Any], decoder: Decoder[RobotState]) -> list[Finding]:
    own = about("doctor")
    if decoder.refused:
        found = f"messages refused: {decoder.last_refusal}"
        return [Finding("bad", "schema", found, "install the same farhand on both hosts")]
    if not facts:
        return []
    if facts.get("schema") != own["schema"]:
        found = f"the robot speaks {facts.get('schema')}, this host {own['schema']}"
        return [Finding("bad", "schema", found, "install the same farhand on both hosts")]
    if (facts.get("farhand"), facts.get("zenoh")) != (own["farhand"], own["zenoh"]):
        found = f"robot {facts.get('farhand')} on Zenoh {facts.get('zenoh')}, here {own['farhand']} on {own['zenoh']}"
        return [Finding("note", "versions", found, "better install the same on both hosts")]
    return [Finding("good", "versions", f"farhand {own['farhand']}, schema {own['schema']} on both hosts")]


def _rights(where: str, facts: dict[str, Any]) -> Finding:
    if facts.get("realtime"):
        return Finding("good", f"scheduling, {where}", "SCHED_FIFO is granted")
    remedy = "allow it: rtprio 20 in /etc/security/limits.d, or LimitRTPRIO=20 in the systemd unit"
    return Finding("note", f"scheduling, {where}", "SCHED_FIFO is not granted: late ticks under load", remedy)


def _certificate(folder: TlsFolder, robot: str) -> list[Finding]:
    own = folder.own
    findings = [Finding("good", "certificate", f"{own.name}, until {own.end} ({own.days_left:.0f} days)")]
    if own.robots and robot not in own.robots:
        remedy = f"issue one with --robot {robot}"
        findings.append(
            Finding("bad", "certificate", f"named for {', '.join(own.robots)}, not {robot!r}", remedy)
        )
    for line in folder.warnings:
        level = "bad" if "ends in 0 days" in line else "note"
        findings.append(Finding(level, "certificate", line, "`farhand certs renew NAME`, copy, restart"))
    return findings
