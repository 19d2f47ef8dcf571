"""Prints what a program publishes, one JSON line a message; connects over loopback on its host."""

import json
import queue
import sys

import zenoh

from common.codec import Decoder
from common.keys import command_key, kind_of, state_key
from common.messages import RobotState, VelocityCommand
from common.tls import load_folder
from common.zenoh_link import open_session
from farhand.process import die_with_parent


def main(endpoint: str, tls: str, robot: str) -> None:
    """Print until the process is ended."""
    die_with_parent()
    lines: queue.SimpleQueue[str] = queue.SimpleQueue()
    states, commands = Decoder(RobotState), Decoder(VelocityCommand)

    def receive(sample: zenoh.Sample) -> None:
        payload = sample.payload.to_bytes()
        if kind_of(str(sample.key_expr)) == "state":
            state = states.decode(payload)
            if state is not None:
                speed = max(map(abs, state.velocity))
                lines.put(
                    json.dumps(
                        {
                            "state": state.seq,
                            "session": state.session,
                            "sample_ns": state.t_sample_ns,
                            "speed": speed,
                            "mode": state.mode,
                            "reason": state.reason,
                            "applied": [state.applied_session, state.applied_seq],
                            "applied_for_ns": state.applied_for_ns,
                            "refused": state.refused,
                            "clearance": state.min_clearance,
                        }
                    )
                )
        else:
            command = commands.decode(payload)
            if command is not None:
                echo = [command.echo.session, command.echo.t_sent_ns] if command.echo else None
                row = {
                    "command": [command.session, command.seq],
                    "mode": command.mode,
                    "echo": echo,
                    "bytes": payload.hex(),
                }
                lines.put(json.dumps(row))

    session = open_session([endpoint], extra=load_folder(tls, "observer").settings("observer"))
    for key in (state_key(robot), command_key(robot)):
        session.declare_subscriber(key, receive)
    while True:
        print(lines.get(), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
