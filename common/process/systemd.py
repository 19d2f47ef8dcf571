"""What systemd is told of a robot's program (sd_notify(3)): that it is ready, and that its loop still turns.

Nothing is sent unless systemd asks for it by the environment variables NOTIFY_SOCKET and WATCHDOG_USEC.
"""

import os
import socket
import threading
from collections.abc import Mapping

from farhand.common.link.link import Link, Packet

LOOK_EVERY = 0.2
"""How often the loop is looked at where systemd wants no watchdog (s)."""


class CountingLink:
    """A link that counts how often its node has looked for messages, which it does once a step."""

    def __init__(self, link: Link) -> None:
        self._link = link
        self.steps = 0

    def send(self, packet: Packet) -> None:
        """Hand a packet over for sending."""
        self._link.send(packet)

    def receive(self) -> list[Packet]:
        """Everything that has arrived since the last call; counts the step."""
        self.steps += 1
        return self._link.receive()


def watchdog_interval(environment: Mapping[str, str]) -> float | None:
    """How often systemd must hear from this process (s), a third of its patience; None: it does not watch."""
    text = environment.get("WATCHDOG_USEC", "")
    if not text.isdigit() or int(text) == 0:
        return None
    if environment.get("WATCHDOG_PID", str(os.getpid())) != str(os.getpid()):
        return None
    return int(text) / 3e6


def notify(address: str, text: str) -> bool:
    """Send one message to systemd; False where it cannot be reached."""
    try:
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC) as sender:
            sender.settimeout(1.0)
            sender.sendto(text.encode(), "\0" + address[1:] if address.startswith("@") else address)
    except OSError:
        return False
    return True


def tell_systemd(
    link: Link, stop_event: threading.Event, environment: Mapping[str, str] | None = None
) -> Link:
    """The link to give to the node, so that systemd hears of its steps; the same link without systemd.

    A thread of its own sends READY=1 after the first step, and WATCHDOG=1 for as long as there have been
    steps since the last: a loop that hangs is silent, and systemd starts the program anew.
    """
    environment = os.environ if environment is None else environment
    address = environment.get("NOTIFY_SOCKET", "")
    if not address:
        return link
    counting = CountingLink(link)
    interval = watchdog_interval(environment)

    def watch() -> None:
        ready, seen = False, 0
        while not stop_event.wait(interval or LOOK_EVERY):
            if counting.steps == seen:
                continue
            seen = counting.steps
            notify(address, "WATCHDOG=1" if ready else "READY=1\nWATCHDOG=1")
            ready = True
            if interval is None:
                return

    threading.Thread(target=watch, name="systemd", daemon=True).start()
    return counting
