"""Prints what a program publishes, one JSON line a message; over loopback on its host.

It connects to an endpoint, or listens at one (`listen=ENDPOINT`) for a program that connects to it: so it outlives that
program, and hears the next from its first message on. `slow` makes it a reader that takes a second for each message,
in Zenoh's own thread.
"""

import json
import queue
import sys
import threading
from typing import Any

import zenoh

from farhand.common.link.zenoh_link import open_session
from farhand.common.messages.codec import Decoder
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.keys import command_key, kind_of, report_key, state_key
from farhand.common.messages.report import ControlReport
from farhand.common.messages.state import RobotState
from farhand.common.process.signals import die_with_parent
from farhand.common.trust.tls import load_folder

SLOWNESS = 1.0
LISTEN = "listen="


def state_row(state: RobotState) -> dict[str, Any]:
    """What matters of a robot's state."""
    return {
        "state": state.seq,
        "session": state.session,
        "sample_ns": state.t_sample_ns,
        "speed": max(map(abs, state.velocity)),
        "mode": state.mode,
        "reason": state.reason,
        "holder": state.holder,
        "applied": [state.applied_session, state.applied_seq],
        "applied_for_ns": state.applied_for_ns,
        "received": state.received,
        "refused": state.refused,
        "clearance": state.clearance,
    }


def command_row(command: VelocityCommand) -> dict[str, Any]:
    """What matters of a command."""
    return {
        "command": [command.session, command.seq],
        "mode": command.mode,
        "echo": [command.echo.session, command.echo.t_sent_ns] if command.echo else None,
    }


def report_row(report: ControlReport) -> dict[str, Any]:
    """What matters of an operator's report."""
    return {"report": report.seq, "session": report.session, "states": report.states}


def main(endpoint: str, tls: str, robot: str, pace: str = "") -> None:
    """Print until the process is ended."""
    die_with_parent()
    lines: queue.SimpleQueue[str] = queue.SimpleQueue()
    states, commands, reports = Decoder(RobotState), Decoder(VelocityCommand), Decoder(ControlReport)

    def row_of(kind: str, payload: bytes) -> dict[str, Any] | None:
        if kind == "state":
            state = states.decode(payload)
            return state_row(state) if state is not None else None
        if kind == "command":
            command = commands.decode(payload)
            return command_row(command) | {"bytes": payload.hex()} if command is not None else None
        report = reports.decode(payload)
        return report_row(report) if report is not None else None

    def receive(sample: zenoh.Sample) -> None:
        row = row_of(kind_of(str(sample.key_expr)), sample.payload.to_bytes())
        if row is not None:
            lines.put(json.dumps(row))
        if pace == "slow":
            threading.Event().wait(SLOWNESS)

    extra = load_folder(tls, "observer").settings("observer") if tls else ()
    at = endpoint.removeprefix(LISTEN)
    session = open_session([at] if at == endpoint else [], [] if at == endpoint else [at], extra=extra)
    for key in (state_key(robot), command_key(robot), report_key(robot)):
        session.declare_subscriber(key, receive)
    while True:
        print(lines.get(), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
