"""Attacks on a robot or a port, each for a few seconds: flood, replay, garbage. For tests of one's own robots."""

import secrets
import socket
import sys
import threading
from pathlib import Path

from common.clock import SystemClock, to_ns
from common.codec import encode
from common.keys import command_key
from common.messages import VelocityCommand
from common.tls import load_folder
from common.zenoh_link import open_session
from farhand.process import die_with_parent
from farhand.robots import meet

FLOOD_HZ = 10_000
LENGTH = 5.0


def commands(kind: str, endpoint: str, tls: str, robot: str, recorded: str = "") -> int:
    """Flood with commands of our own at 10,000 a second, or replay recorded ones; returns how many were sent."""
    session = open_session([endpoint], extra=load_folder(tls, "operator").settings("operator"))
    if not meet(session, 10.0):
        return 0
    clock, own, sent = SystemClock(), secrets.randbelow(1 << 60) + 1, 0
    old = [bytes.fromhex(line) for line in Path(recorded).read_text().split()] if recorded else []
    start_ns = clock.now_ns()
    while (now_ns := clock.now_ns()) < start_ns + to_ns(LENGTH):
        while sent < (now_ns - start_ns) * 1e-9 * (FLOOD_HZ if kind == "flood" else 100):
            if kind == "flood":
                payload = encode(
                    VelocityCommand(
                        source="attacker",
                        session=own,
                        seq=sent,
                        t_sent_ns=now_ns,
                        mode="run",
                        velocity=(0.5, 0.0, 0.5),
                    )
                )
            else:
                payload = old[sent % len(old)]
            session.put(command_key(robot), payload)
            sent += 1
        clock.sleep_until(now_ns + 1_000_000)
    session.close()  # type: ignore[no-untyped-call]
    return sent


def garbage(host: str, *ports: str) -> int:
    """Try every port below 2000, then send random bytes to the listening ones and hang up; returns how often."""
    clock, times = SystemClock(), 0
    for low_port in range(1, 2000):
        with socket.socket() as probe:
            probe.settimeout(0.05)
            probe.connect_ex((host, low_port))
    end_ns = clock.now_ns() + to_ns(LENGTH)
    while clock.now_ns() < end_ns:
        for port in ports:
            try:
                with socket.create_connection((host, int(port)), 1.0) as connection:
                    connection.sendall(secrets.token_bytes(4096))
                    times += 1
            except OSError:
                pass
        threading.Event().wait(0.01)
    return times


def main() -> None:
    """KIND ARGUMENTS..."""
    die_with_parent()
    kind, *arguments = sys.argv[1:]
    print(garbage(*arguments) if kind == "garbage" else commands(kind, *arguments), flush=True)


if __name__ == "__main__":
    main()
