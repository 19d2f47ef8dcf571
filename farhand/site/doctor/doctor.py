"""`farhand doctor`: what is wrong on the path to a robot, and what to do about it.

It asks with the program's own certificate, from the operator's host, and disturbs nobody: it sends no
command. Round trip and loss are measured by the `about` question, which goes the way that commands go.
"""

from typing import Any

import zenoh

from farhand.common.errors import CertificateError, EndpointError
from farhand.common.link.endpoints import check_device, check_name
from farhand.common.link.zenoh_link import open_session
from farhand.common.messages.codec import Decoder
from farhand.common.messages.keys import about_key
from farhand.common.messages.state import RobotState
from farhand.common.process.security import tool_place
from farhand.common.trust.tls import TlsFolder, load_folder
from farhand.runs.scenario import Scenario
from farhand.site.doctor.description import DESCRIPTION_TIME, Listening, judge_robot
from farhand.site.doctor.facts import judge, own_certificate, rights, this_host
from farhand.site.doctor.network import probe_tcp, probe_tls
from farhand.site.doctor.path import decoded_facts, judge_path, measure
from farhand.site.findings import Finding, print_findings
from farhand.site.robots import MEET_TIME, alive, meet

FACTS_TIME = 2.0
OPEN_TIME_MS = 3000


def run_doctor(
    endpoint: str, robot: str, tls: str, scenario: Scenario, count: int, as_json: bool, router: bool = False
) -> int:
    """Check everything and print it; returns 1 if anything is in the way, else 0.

    Args:
        endpoint: where the operator's program connects to.
        robot: its name.
        tls: certificate folder; empty: none.
        scenario: what the path must be good enough for.
        count: questions that measure the path.
        as_json: print JSON instead of a table.
        router: the endpoint is a Zenoh router's.
    """
    check_device(check_name(endpoint))
    return print_findings(
        f"the path to {robot}", examine(endpoint, robot, tls, scenario, count, router), as_json=as_json
    )


def examine(
    endpoint: str, robot: str, tls: str, scenario: Scenario, count: int, router: bool = False
) -> list[Finding]:
    """The findings, in order; what cannot be looked at for an earlier fault is left out."""
    findings: list[Finding] = []
    folder: TlsFolder | None = None
    if tls:
        try:
            folder = load_folder(tls)
        except CertificateError as error:
            remedy = "see docs/two-hosts.md, Certificates"
            if "clock" in str(error):
                remedy = "set this host's clock if it is wrong; else renew, copy the folder, restart"
            return [Finding("bad", "certificate", str(error), remedy)]
        findings += own_certificate(folder, robot)
    elif endpoint.startswith("tls/"):
        return [Finding("bad", "certificate", "none given", "give this program's folder with --tls DIR")]
    if folder is not None and not endpoint.startswith("tls/"):
        remedy = f"give --connect tls/{endpoint.partition('/')[2]}, or leave --tls out"
        return [*findings, Finding("bad", "endpoint", f"{endpoint} is not a TLS endpoint", remedy)]
    findings.append(rights("this host", this_host()))
    findings.append(probe_tcp(endpoint))
    if findings[-1].level != "bad" and folder is not None:
        findings.append(probe_tls(endpoint, folder))
    if findings[-1].level == "bad":
        return findings
    extra = [*(folder.settings(tool_place(folder)) if folder else ())]
    extra.append(("transport/unicast/open_timeout", OPEN_TIME_MS))
    if router:
        extra.append(("connect/timeout_ms", OPEN_TIME_MS))
    try:
        session = open_session([endpoint], mode="client" if router else "peer", extra=extra)
    except EndpointError:  # a client's session that finds no router
        return [*findings, _no_zenoh(endpoint)]
    try:
        return findings + _ask(session, endpoint, robot, scenario, count, router)
    finally:
        session.close()  # type: ignore[no-untyped-call]


def _no_zenoh(endpoint: str) -> Finding:
    remedy = "is it a farhand program or a router? if it wants TLS, give tls/... and --tls DIR"
    return Finding("bad", "Zenoh", f"{endpoint} answers, but not as a part of Zenoh", remedy)


def _ask(
    session: zenoh.Session, endpoint: str, robot: str, scenario: Scenario, count: int, router: bool
) -> list[Finding]:
    if not meet(session, MEET_TIME):
        return [_no_zenoh(endpoint)]
    present, own = alive(session), this_host()
    findings = _router(session, router)
    if "netem" in present:
        findings.append(Finding("good", "emulator", "between here and the robot"))
        emulators = _facts(session, about_key("netem", "netem"))
        for facts in emulators:
            findings += judge("emulator", facts, own)
        if not emulators:
            remedy = "is it overloaded, or its farhand an old one? install the same on all hosts"
            findings.append(Finding("note", "emulator", "does not say what it is", remedy))
    else:
        findings.append(Finding("good", "emulator", "none between here and the robot"))
    if "robot" not in present.get(robot, set()):
        there = ", ".join(n for n in sorted(present) if "robot" in present[n]) or "no robot"
        remedy = "start `farhand robot`, or see --robot; with TLS look at the members/ on the way"
        if not router and session.info.routers_zid():
            remedy += "; give --router here, and there"
        return [*findings, Finding("bad", "robot", f"{robot!r} is not there; there is: {there}", remedy)]
    findings.append(Finding("good", "robot", "there"))
    with Listening(session, robot) as heard:
        answers = measure(session, about_key(robot, "robot"), count)
        heard.wait_for_description(DESCRIPTION_TIME)
    if answers.facts:
        findings += judge("robot", answers.facts, own)
    findings += judge_path(answers, scenario)
    return [*findings, _states(heard.states, heard.decoder), *judge_robot(heard, scenario)]


def _router(session: zenoh.Session, router: bool) -> list[Finding]:
    """Whether the other end is what the user thinks it is."""
    if session.info.routers_zid():
        if router:
            return [Finding("good", "router", "a Zenoh router is on the way")]
        remedy = "give --router to all programs that connect to it: it does not route between peers"
        return [
            Finding("note", "router", "the other end is a Zenoh router, and --router is not given", remedy)
        ]
    if router:
        found = "the other end is a farhand program, not a Zenoh router"
        return [Finding("note", "router", found, "leave --router out")]
    return []


def _facts(session: zenoh.Session, key: str) -> list[dict[str, Any]]:
    """What everybody says of itself who answers under a key."""
    found: dict[str, dict[str, Any]] = {}
    replies = session.get(
        key,
        timeout=FACTS_TIME,
        target=zenoh.QueryTarget.ALL,
        consolidation=zenoh.ConsolidationMode.NONE,
    )
    for reply in replies:
        if reply.ok is not None and (facts := decoded_facts(reply.ok.payload.to_bytes())) is not None:
            found[str(reply.replier_id)] = facts
    return list(found.values())


def _states(count: int, decoder: Decoder[RobotState]) -> Finding:
    refused = sum(decoder.refused.values())
    if count and refused:
        found = f"{count} arrived, {refused} refused: {decoder.last_refusal}"
        return Finding("note", "states", found, "is something on the way corrupting messages?")
    if count:
        return Finding("good", "states", f"{count} arrived")
    if decoder.refused:
        found = f"messages refused: {decoder.last_refusal}"
        return Finding("bad", "states", found, "install the same farhand on all hosts")
    remedy = "with TLS, is this certificate named for the robot everywhere on the way?"
    return Finding("bad", "states", "none arrived", remedy)
