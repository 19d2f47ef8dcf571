"""What the emulation in the kernel asks of this host: commands, their refusals, and network devices."""

import os
import socket
import subprocess
from collections.abc import Callable, Mapping, Sequence

import psutil

from farhand.common.errors import InputError

HANDLE = "fa4d:"
"""Of the queues that are made here, by which they are known again."""

Run = Callable[[Sequence[str], Mapping[str, str]], tuple[int, str, str]]
"""Runs a command with further environment variables; returns exit code, stdout, stderr."""


def run_command(command: Sequence[str], environment: Mapping[str, str]) -> tuple[int, str, str]:
    """Run a command; exit code 127 where there is none of that name."""
    try:
        done = subprocess.run(
            command,
            capture_output=True,
            text=True,
            timeout=10,
            check=False,
            env=os.environ | dict(environment),
        )
    except FileNotFoundError:
        return 127, "", f"{command[0]}: not found"
    except subprocess.TimeoutExpired:
        return 124, "", f"{command[0]}: no answer within 10 s"
    return done.returncode, done.stdout, done.stderr


def refusal(command: Sequence[str], stderr: str) -> InputError:
    """What to tell the user of a command that failed, in one line."""
    if "not permitted" in stderr or "denied" in stderr:
        why = "needs the capability NET_ADMIN: run as root, in a container with cap_add: [NET_ADMIN]"
    elif "qdisc" in stderr and ("unknown" in stderr.lower() or "not found" in stderr):
        why = "this kernel has no sch_netem (modprobe sch_netem); use --backend message"
    elif command[0] in stderr and "not found" in stderr:
        why = f"there is no program {command[0]!r}; install iproute2"
    elif "Cannot find device" in stderr:
        why = f"there is no network device {command[list(command).index('dev') + 1]!r}"
    else:
        why = f"{' '.join(command)}: {' '.join(stderr.split())[:200]}"
    return InputError(f"--backend tc: {why}")


def addresses() -> dict[str, list[str]]:
    """Addresses of this host by network device."""
    return {name: [each.address for each in found] for name, found in psutil.net_if_addrs().items()}


def find_device(
    endpoint: str, option: str, known: Callable[[], Mapping[str, Sequence[str]]] = addresses
) -> str:
    """Name of the device that an endpoint listens on; raises InputError that tells to name it."""
    host = endpoint.split("/", 1)[-1].rsplit(":", 1)[0].strip("[]")
    try:
        address = socket.getaddrinfo(host, None, type=socket.SOCK_STREAM)[0][4][0]
    except OSError:
        raise InputError(
            f"--backend tc: the host of {endpoint} has no address; name the device with {option}"
        ) from None
    for name, found in known().items():
        if address in found:
            return name
    raise InputError(
        f"--backend tc: no device has the address {address} of {endpoint}; name the device with {option}"
    )


def claim(device: str) -> socket.socket:
    """Claim a device until the socket is closed, by whatever end; raises InputError if it is claimed.

    The name is the network namespace's own, as the device's is.
    """
    found = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    try:
        found.bind(f"\0farhand-tc-{device}")
    except OSError:
        found.close()
        raise InputError(
            f"--backend tc: another emulation that runs has the device {device}; end it first"
        ) from None
    return found
