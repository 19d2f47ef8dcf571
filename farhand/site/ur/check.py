"""`farhand ur check`: whether a UR arm can be driven from here, and what to do about what is in the way.

It moves nothing. To measure the controller's loop it runs Farhand's own program there for a second, at speed zero.
"""

import re
from collections.abc import Callable
from typing import Any

import numpy as np

from farhand.common.timing.clock import SystemClock, to_ns
from farhand.common.timing.realtime import request_realtime
from farhand.robot_side.arm.model import ArmModel
from farhand.robot_side.ur import poses
from farhand.robot_side.ur.dashboard import Dashboard, DashboardError
from farhand.robot_side.ur.deadline import measured_deadline
from farhand.robot_side.ur.errands import send_program
from farhand.robot_side.ur.link import UrLink
from farhand.robot_side.ur.program import LIMITS, STANDS_WITHIN
from farhand.robot_side.ur.settings import UrSettings
from farhand.robot_side.ur.states import PLAYING, REDUCED, SAFETY_MODES, Facts, blocked, slowed, unready
from farhand.site.findings import Finding, print_findings

PATIENCE = 4.0
MEASURED_FOR = 2.0
LATE = 0.05
"""s of round trip from which the controller answers too late to be driven well."""
SAME_PAYLOAD, SAME_PLACE, APART = 0.005, 0.002, 0.02
_NAMED = re.compile(r"UR\d+e?\Z", re.IGNORECASE)
_TELLS = 1 << 20  # in that register: the question has been answered


def run_check(host: str, arm: ArmModel | None, settings: UrSettings, lag: float, as_json: bool) -> int:
    """Look at everything and print it; returns 1 if anything is in the way, else 0.

    Args:
        host: address of the controller.
        arm: that it shall be; None: whatever it is.
        settings: what the scenario says of payload, tool and deadline.
        lag: with which the scenario says that the arm answers (s).
        as_json: print JSON instead of a table.
    """
    return print_findings(f"the UR controller at {host}", examine(host, arm, settings, lag), as_json=as_json)


def examine(host: str, arm: ArmModel | None, settings: UrSettings, lag: float) -> list[Finding]:
    """The findings, in order; what cannot be looked at for an earlier fault is left out."""
    findings: list[Finding] = []
    try:
        with Dashboard(host) as dashboard:
            said = {
                word: dashboard.ask(word)
                for word in ("PolyscopeVersion", "get robot model", "is in remote control")
            }
    except DashboardError as error:
        remedy = (
            "is it the address at the pendant (Settings, Network)? is the dashboard on (Security, Services)?"
        )
        return [Finding("bad", "dashboard", str(error), remedy)]
    findings.append(Finding("good", "dashboard", said["PolyscopeVersion"]))
    findings += _model(said["get robot model"], arm)
    findings += _remote(said["is in remote control"])
    clock = SystemClock()
    acceleration = 15.0 if arm is None else float(arm.max_acceleration.max())
    link = UrLink(host, settings, acceleration)
    try:
        facts = _first(link, clock)
        if facts.trouble or not facts.values:
            remedy = "end the other client; else: are RTDE and its input registers free (Security, Services)?"
            return [*findings, Finding("bad", "RTDE", facts.trouble or "no state comes", remedy)]
        version = ".".join(map(str, (link.client.version or ())[:3]))
        findings.append(Finding("good", "RTDE", f"software {version}, {link.client.rate_hz:g} Hz"))
        findings += judge_state(facts, settings)
        findings += _joints(facts, arm)
        if not any(finding.level == "bad" for finding in findings):
            findings += _limits(host, link, arm, clock)
            findings += _loop(link, settings, lag, clock)
        else:
            findings.append(
                Finding("note", "loop", "not measured: something is in the way", "clear that, check again")
            )
    finally:
        link.close()
    return findings


def judge_state(facts: Facts, settings: UrSettings) -> list[Finding]:
    """What the controller's newest state says; pure."""
    values = facts.values
    safety = int(values["safety_mode"])
    found = []
    why = blocked(facts)
    if why:
        found.append(Finding("bad", "state", why, "farhand ur recover walks through it"))
    elif safety == REDUCED:
        remedy = "its limits are lower than usual: leave the reduced mode, or keep far below them"
        found.append(Finding("note", "state", "reduced mode", remedy))
    else:
        found.append(Finding("good", "state", f"running, safety {SAFETY_MODES.get(safety, str(safety))}"))
    if int(values["runtime_state"]) == PLAYING:
        found.append(
            Finding(
                "bad",
                "program",
                "another program runs",
                "end it at the pendant, or whoever runs it: one client",
            )
        )
    scaled = slowed(values)
    remedy = "commanded speeds take effect by so much; move the slider up where that is not wanted"
    found.append(
        Finding("note", "speed", scaled, remedy) if scaled else Finding("good", "speed", "full scaling")
    )
    return found + _payload(facts, settings) + _tool(facts, settings)


def _payload(facts: Facts, settings: UrSettings) -> list[Finding]:
    has, wanted = facts.values.get("payload"), settings.payload
    if has is None:
        return [
            Finding(
                "note", "payload", "this software does not say it", "look at the pendant that it is right"
            )
        ]
    if wanted is None:
        remedy = "is it? a wrong one means drift and protective stops; robot.ur.payload has Farhand set and watch it"
        return [Finding("note", "payload", f"{has:g} kg", remedy)]
    if has > SAME_PAYLOAD and abs(has - wanted) > SAME_PAYLOAD:
        remedy = "set the one that is true, at the pendant or in the scenario"
        return [Finding("bad", "payload", f"{has:g} kg, the scenario has {wanted:g} kg", remedy)]
    return [Finding("good", "payload", f"{wanted:g} kg, by the scenario; the controller has {has:g} kg")]


def _tool(facts: Facts, settings: UrSettings) -> list[Finding]:
    has = facts.values.get("tcp_offset")
    if has is None:
        return [
            Finding("note", "tool", "this software does not say it", "look at the pendant that it is right")
        ]
    said = ", ".join(f"{each * 1e3:.1f}" for each in has[:3])
    if settings.tcp is None:
        return [Finding("good", "tool", f"at {said} mm from the flange; Farhand steers the flange itself")]
    away = float(np.linalg.norm(np.array(has) - np.array(settings.tcp)))
    if away > 1e-3:
        return [Finding("note", "tool", f"at {said} mm; the scenario's is set at the start of the program")]
    return [Finding("good", "tool", f"at {said} mm, as in the scenario")]


def _model(said: str, arm: ArmModel | None) -> list[Finding]:
    if arm is None or not _NAMED.match(arm.title) or not _NAMED.match(said):
        return [Finding("good", "model", said)]
    if said.upper().rstrip("E") != arm.title.upper().rstrip("E"):
        return [
            Finding(
                "bad",
                "model",
                f"{said}, not a {arm.title}",
                "give the scenario its model, or the right --host",
            )
        ]
    return [Finding("good", "model", said)]


def _remote(said: str) -> list[Finding]:
    if said.lower() == "false":
        remedy = "enable remote control (Settings, System) and choose it at the pendant's top right"
        return [Finding("bad", "control", "local mode: programs from here are refused", remedy)]
    if said.lower() == "true":
        return [Finding("good", "control", "remote")]
    return [Finding("good", "control", "this software has no remote mode")]


def _joints(facts: Facts, arm: ArmModel | None) -> list[Finding]:
    if arm is None:
        return []
    q = np.array(facts.values["actual_q"])
    for name, angle, low, high in zip(arm.joint_names, q, arm.lower, arm.upper, strict=True):
        if not low <= angle <= high:
            outside = f"{name} stands at {angle:.3f} rad, Farhand keeps it within {low:.3f} to {high:.3f}"
            return [Finding("bad", "joints", outside, "move it there at the pendant")]
    found = [Finding("good", "joints", "all within the limits that Farhand keeps")]
    tcp = facts.values.get("tcp_offset")
    if tcp is None:
        return found
    ours = np.array(poses.tcp_pose(arm, q, tcp)[:3])
    away = float(np.linalg.norm(ours - np.array(facts.values["actual_TCP_pose"][:3])))
    if away > APART:
        remedy = "it is another arm than the scenario's, or another generation of it"
        return [
            *found,
            Finding("bad", "kinematics", f"the tool is {away * 1e3:.0f} mm from where ours has it", remedy),
        ]
    if away > SAME_PLACE:
        remedy = "by its own calibration; Farhand's distances are off by as much: keep a larger guard.d_min"
        return [
            *found,
            Finding("note", "kinematics", f"the tool is {away * 1e3:.1f} mm from where ours has it", remedy),
        ]
    return [*found, Finding("good", "kinematics", f"the tool is {away * 1e3:.2f} mm from where ours has it")]


def _first(link: UrLink, clock: SystemClock) -> Facts:
    end_ns = clock.now_ns() + to_ns(PATIENCE)
    while True:
        now_ns = clock.now_ns()
        facts = link.poll(now_ns, starts=False)
        if (facts.values and not facts.trouble) or now_ns > end_ns:
            return facts
        clock.sleep_until(now_ns + to_ns(0.002))


def _limits(host: str, link: UrLink, arm: ArmModel | None, clock: SystemClock) -> list[Finding]:
    """Ask the controller whether each joint may go where ours may."""
    if arm is None:
        return []
    q = link.client.values["actual_q"]
    try:
        send_program(host, limits_question(arm, q))
    except OSError as error:
        found = f"port 30002 does not take programs: {error.strerror or error}"
        return [
            Finding("bad", "programs", found, "enable the secondary client interface (Security, Services)")
        ]
    bits = _await(link, clock, lambda values: int(values.get(LIMITS, 0)))
    if not bits & _TELLS:
        return [
            Finding(
                "note", "limits", "the controller did not say its own", "compare them at the pendant (Safety)"
            )
        ]
    narrow = [name for i, name in enumerate(arm.joint_names) if not bits >> i & 1]
    if narrow:
        found = f"the controller's safety limits are narrower than Farhand's for {', '.join(narrow)}"
        remedy = "it stops there before Farhand brakes: keep the task away from them, or make them wider"
        return [Finding("note", "limits", found, remedy)]
    return [Finding("good", "limits", "the controller lets every joint go wherever Farhand's limits let it")]


def limits_question(arm: ArmModel, q: list[float]) -> str:
    """A program that moves nothing: bit i of a register says whether joint i may stand at both of its limits."""
    lines = ["sec farhand_asks():", "  bits = 0"]
    for i in range(arm.n):
        ends = []
        for angle in (arm.lower[i] + 0.01, arm.upper[i] - 0.01):
            there = [*q[:i], float(angle), *q[i + 1 :]]
            ends.append(f"is_within_safety_limits([{', '.join(f'{each:.6f}' for each in there)}])")
        lines += [f"  if {' and '.join(ends)}:", f"    bits = bits + {1 << i}", "  end"]
    lines += [f"  write_output_integer_register(27, bits + {_TELLS})", "end", ""]
    return "\n".join(lines)


def _await(link: UrLink, clock: SystemClock, read: Callable[[dict[str, Any]], int]) -> int:
    end_ns = clock.now_ns() + to_ns(1.0)
    while True:
        now_ns = clock.now_ns()
        facts = link.poll(now_ns, starts=False)
        found = read(facts.values)
        if found & _TELLS or now_ns > end_ns:
            return found
        clock.sleep_until(now_ns + to_ns(0.002))


def _loop(link: UrLink, settings: UrSettings, lag: float, clock: SystemClock) -> list[Finding]:
    request_realtime()  # as the robot's program does
    deadline = measured_deadline(link, settings, clock)
    remedy = "" if deadline.kept else f"do not drive: {STANDS_WITHIN:g} s is what may pass"
    found = [Finding("good" if deadline.kept else "bad", "deadline", deadline.said, remedy)]
    trips, gaps = _measure(link, clock)
    if not trips or not gaps:
        why = unready(link.facts(clock.now_ns()))
        return [
            *found,
            Finding("bad", "loop", f"the program does not answer: {why}", "look at the pendant's log"),
        ]
    trip, gap = np.quantile(trips, (0.5, 0.99)), np.quantile(gaps, (0.5, 0.99))
    said = (
        f"round trip {trip[0] * 1e3:.1f} ms, 99 % within {trip[1] * 1e3:.1f} ms, at most {max(trips) * 1e3:.1f} ms; "
        f"states every {gap[0] * 1e3:.1f} ms, 99 % within {gap[1] * 1e3:.1f} ms, at most {max(gaps) * 1e3:.1f} ms"
    )
    if max(trips) > LATE:
        level = "bad" if trip[1] > LATE else "note"
        remedy = "a wired network of its own; real-time priority for the program"
        return [*found, Finding(level, "loop", said, remedy)]
    if trip[1] > 1.5 * lag:
        remedy = f"robot.lag says {lag * 1e3:.0f} ms; say at least {trip[1] / 1.5 * 1e3:.0f} ms, the guard counts on it"
        return [*found, Finding("note", "loop", said, remedy)]
    return [*found, Finding("good", "loop", said)]


def _measure(link: UrLink, clock: SystemClock) -> tuple[list[float], list[float]]:
    """Round trips, and times between states (s)."""
    trips: list[float] = []
    gaps: list[float] = []
    start_ns = clock.now_ns()
    arrived: int | None = None
    step = to_ns(1.0 / link.client.rate_hz)
    due_ns = start_ns
    while (now_ns := clock.now_ns()) < start_ns + to_ns(MEASURED_FOR):
        link.poll(now_ns, starts=False)
        if now_ns >= due_ns:
            link.send([0.0] * 6, now_ns)
            due_ns += step
        trip = link.take_longest_round_trip()
        if trip:
            trips.append(trip)
        if link.client.arrived_ns != arrived:
            if arrived is not None and link.client.arrived_ns is not None:
                gaps.append((link.client.arrived_ns - arrived) * 1e-9)
            arrived = link.client.arrived_ns
        clock.sleep_until(now_ns + 200_000)
    link.end_program()
    return trips, gaps
