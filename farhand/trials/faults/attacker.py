"""Attacks on a robot or a port, each bounded in time. For tests of one's own robots.

`python -m farhand.trials.faults.attacker KIND ...` prints one JSON object at its end: whether it was connected, what
it sent, and how many states of the robot it could read.
"""

import argparse
import json
import secrets
import socket
import threading
from pathlib import Path

from farhand.common.link.zenoh_link import open_session
from farhand.common.messages.base import Echo
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.command import CommandMode, VelocityCommand
from farhand.common.messages.keys import command_key, state_key
from farhand.common.messages.state import RobotState
from farhand.common.process.signals import die_with_parent
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.common.trust.certificate import read_certificate
from farhand.common.trust.tls import TlsFolder
from farhand.site.robots import meet

MEET_TIME = 10.0
SECOND_NS = 1_000_000_000


def settings(folder: str, authority: str) -> list[tuple[str, object]]:
    """Session settings of one who obeys no rule of ours: TLS with what is there, no access control.

    Args:
        folder: with the attacker's certificate; empty: none.
        authority: the certificate authority that the attacker trusts; empty: the folder's.
    """
    own: list[tuple[str, object]] = []
    if folder:
        path = Path(folder)
        authority_of = read_certificate(path / "ca.pem")
        member = TlsFolder(path, authority_of, read_certificate(path / "cert.pem"), (), ())
        own = [each for each in member.settings("operator") if each[0] != "access_control"]
    if authority:
        own.append(("transport/link/tls/root_ca_certificate", authority))
    return own


def join(listen: str) -> list[tuple[str, object]]:
    """Settings of a peer that looks for others by every means that Zenoh has, and listens itself."""
    return [
        ("scouting/multicast/enabled", True),
        ("scouting/multicast/autoconnect", ["router", "peer", "client"]),
        ("scouting/gossip/enabled", True),
        ("listen/endpoints", [listen]),
    ]


class Commander:
    """Sends commands as cleverly as it can: built on the newest state, if it can read any.

    Args:
        robot: whose keys.
        recorded: payloads to send instead; empty: its own.
    """

    def __init__(self, robot: str, recorded: list[bytes]) -> None:
        self._key, self._states = state_key(robot), Decoder(RobotState)
        self._recorded, self._session = recorded, secrets.randbelow(1 << 60) + 1
        self._state: RobotState | None = None
        self.read = 0

    def take(self, payload: bytes) -> None:
        """A state was read; called in a Zenoh thread."""
        self.read += 1
        self._state = self._states.decode(payload) or self._state

    def payload(self, seq: int, now_ns: int) -> bytes:
        """The command with a sequence number: asks for control now and then, drives otherwise."""
        if self._recorded:
            return self._recorded[seq % len(self._recorded)]
        state = self._state
        mode: CommandMode = "acknowledge" if seq % 50 == 0 else "run"
        return encode(
            VelocityCommand(
                source="attacker",
                session=self._session,
                seq=seq,
                t_sent_ns=now_ns,
                echo=Echo(state.session, state.seq, state.t_sent_ns, 0) if state else None,
                mode=mode,
                velocity=(0.0, 0.0, 0.0) if mode == "acknowledge" else (0.5, 0.0, 0.5),
            )
        )


def send_commands(options: argparse.Namespace) -> dict[str, object]:
    """Connect as told and send commands at a rate for a time."""
    recorded = (
        [bytes.fromhex(line) for line in Path(options.recorded).read_text().split()]
        if options.recorded
        else []
    )
    extra = settings(options.folder, options.authority) + (join(options.join) if options.join else [])
    session = open_session([options.endpoint], extra=extra)
    commander = Commander(options.robot, recorded)
    session.declare_subscriber(
        state_key(options.robot), lambda sample: commander.take(sample.payload.to_bytes())
    )
    connected = meet(session, options.meet)
    clock, sent = SystemClock(), 0
    key = command_key(options.robot)
    start_ns = clock.now_ns()
    while (now_ns := clock.now_ns()) < start_ns + to_ns(options.seconds):
        while sent < (now_ns - start_ns) * options.rate // SECOND_NS:
            session.put(key, commander.payload(sent, now_ns))
            sent += 1
        clock.sleep_until(now_ns + 1_000_000)
    session.close()  # type: ignore[no-untyped-call]
    return {"connected": connected, "sent": sent, "read": commander.read}


def throw_garbage(options: argparse.Namespace) -> dict[str, object]:
    """Try every port below 2000, then send random bytes to the listening ones and hang up."""
    clock, sent = SystemClock(), 0
    targets = [target.rsplit(":", 1) for target in options.targets]
    for host in sorted({host for host, _ in targets}):
        for low_port in range(1, 2000):
            with socket.socket() as probe:
                probe.settimeout(0.05)
                probe.connect_ex((host, low_port))
    end_ns = clock.now_ns() + to_ns(options.seconds)
    reached = set()
    while clock.now_ns() < end_ns:
        for host, port in targets:
            try:
                with socket.create_connection((host, int(port)), 1.0) as connection:
                    reached.add((host, port))
                    connection.sendall(secrets.token_bytes(4096))
                    sent += 1
            except OSError:
                pass
        threading.Event().wait(0.01)
    return {"connected": len(reached) == len(targets), "sent": sent, "read": 0}


def main() -> None:
    """Do what the command line says, and print what came of it."""
    die_with_parent()
    parser = argparse.ArgumentParser(description=__doc__)
    kinds = parser.add_subparsers(dest="kind", required=True)
    command = kinds.add_parser("commands")
    command.add_argument("endpoint")
    command.add_argument("robot")
    command.add_argument("--folder", default="", help="certificate folder")
    command.add_argument("--authority", default="", help="certificate authority to trust")
    command.add_argument("--recorded", default="", help="file of recorded commands, in hexadecimal")
    command.add_argument("--join", default="", help="look for peers, and listen on this endpoint")
    command.add_argument("--rate", type=int, default=100)
    command.add_argument("--seconds", type=float, default=5.0)
    command.add_argument("--meet", type=float, default=MEET_TIME)
    garbage = kinds.add_parser("garbage")
    garbage.add_argument("targets", nargs="+", help="HOST:PORT")
    garbage.add_argument("--seconds", type=float, default=5.0)
    options = parser.parse_args()
    found = throw_garbage(options) if options.kind == "garbage" else send_commands(options)
    print(json.dumps(found), flush=True)


if __name__ == "__main__":
    main()
