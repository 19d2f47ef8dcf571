"""The doctor's measurement of the path: round trip and loss, by a question that goes the way of commands."""

import json
import threading
from dataclasses import dataclass
from typing import Any

import zenoh

from farhand.common.timing.clock import SystemClock, to_ns
from farhand.operator_side.pace import pace_of
from farhand.runs.scenario import Scenario
from farhand.site.findings import Finding

QUESTION_PERIOD = 0.05
ANSWER_TIME = 3.0


@dataclass(frozen=True, slots=True)
class Answers:
    """What the questions brought: how many were asked, round trips (s, sorted), the newest facts."""

    asked: int
    round_trips: tuple[float, ...]
    facts: dict[str, Any]


def measure(session: zenoh.Session, key: str, count: int) -> Answers:
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
            facts.update(decoded_facts(reply.ok.payload.to_bytes()) or {})
            if len(trips) >= count:
                done.set()

        session.get(key, answered, timeout=ANSWER_TIME)

    start_ns = clock.now_ns()
    for number in range(count):
        clock.sleep_until(start_ns + to_ns(number * QUESTION_PERIOD))
        ask()
    done.wait(ANSWER_TIME)
    return Answers(count, tuple(sorted(trips)), facts)


def judge_path(answers: Answers, scenario: Scenario) -> list[Finding]:
    """Whether the path is good enough for a scenario."""
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
    period = pace_of(scenario).tick
    in_a_row = max(1, int(safety.command_timeout / period))
    holds = 60.0 / period * one_way**in_a_row * (1.0 - one_way)
    found += f"; about {holds:.2g} holds a minute from it"
    level = "bad" if holds > 1.0 else "note"
    remedy = "mend the link (radio, cable, congestion); TCP itself loses nothing, so look for an emulator"
    return [*findings, Finding(level, "loss", found, remedy)]


def decoded_facts(payload: bytes) -> dict[str, Any] | None:
    """The answer to an `about` question; None if it is none."""
    try:
        found = json.loads(payload)
    except (ValueError, RecursionError):
        return None
    return found if isinstance(found, dict) else None
