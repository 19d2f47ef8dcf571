"""`farhand netem --backend tc`: the kernel delays and loses packets (tc-netem), the proxy only forwards.

tc-netem acts on what leaves a device: the device on the robot's side carries the uplink, the one on the
operator's side the downlink. What netem measures and reports then holds the kernel's part as the round trip.
"""

import json
import os
import socket
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import msgspec

from common.errors import InputError
from netem.main import NetemSettings
from netem.spec import parse_spec
from netem.tc_words import LIMIT, TABLE, KernelNetwork, kernel_network

Run = Callable[[Sequence[str], Mapping[str, str]], tuple[int, str, str]]
"""Runs a command with further environment variables; returns exit code, stdout, stderr."""


class Device(NamedTuple):
    """What a network device is to emulate."""

    name: str
    network: KernelNetwork


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


def set_commands(device: Device) -> list[list[str]]:
    """The commands that start the emulation on a device; none where there is nothing to emulate."""
    if not device.network.arguments:
        return []
    commands = [
        [
            "tc",
            "qdisc",
            "replace",
            "dev",
            device.name,
            "root",
            "handle",
            "1:",
            "netem",
            *device.network.arguments,
        ]
    ]
    if device.network.in_order:
        # netem's own inner queue sorts by the drawn time; a plain queue keeps the order of arrival (tc-netem(8)).
        pfifo = ["parent", "1:1", "handle", "10:", "pfifo", "limit", str(LIMIT)]
        commands.append(["tc", "qdisc", "add", "dev", device.name, *pfifo])
    return commands


def remove_command(device: Device) -> list[str]:
    """The command that ends the emulation."""
    return ["tc", "qdisc", "del", "dev", device.name, "root"]


def refusal(command: Sequence[str], stderr: str) -> InputError:
    """What to tell the user of a command that failed, in one line."""
    if "not permitted" in stderr or "denied" in stderr:
        why = "needs the capability NET_ADMIN: run as root, in a container with cap_add: [NET_ADMIN]"
    elif "qdisc" in stderr and ("unknown" in stderr.lower() or "not found" in stderr):
        why = "this kernel has no sch_netem (modprobe sch_netem); use --backend message"
    elif command[0] in stderr and "not found" in stderr:
        why = f"there is no program {command[0]!r}; install iproute2"
    elif "Cannot find device" in stderr:
        why = f"there is no network device {command[4]!r}"
    else:
        why = f"{' '.join(command)}: {' '.join(stderr.split())[:200]}"
    return InputError(f"--backend tc: {why}")


def device_with(address: str, addresses: str) -> str | None:
    """Name of the device that has an address, by the JSON of `ip -json address`; None if there is none."""
    for device in json.loads(addresses or "[]"):
        if any(each.get("local") == address for each in device.get("addr_info", [])):
            return str(device["ifname"])
    return None


def find_device(endpoint: str, option: str, run: Run = run_command) -> str:
    """Name of the device that an endpoint listens on; raises InputError that tells to name it."""
    host = endpoint.split("/", 1)[-1].rsplit(":", 1)[0].strip("[]")
    try:
        address = socket.getaddrinfo(host, None, type=socket.SOCK_STREAM)[0][4][0]
    except OSError:
        raise InputError(
            f"--backend tc: the host of {endpoint} has no address; name the device with {option}"
        ) from None
    command = ["ip", "-json", "address"]
    code, stdout, stderr = run(command, {})
    if code:
        raise refusal(command, stderr)
    found = device_with(str(address), stdout)
    if found is None:
        raise InputError(
            f"--backend tc: no device has the address {address} of {endpoint}; name the device with {option}"
        )
    return found


class KernelEmulation:
    """tc-netem on some devices, from `start` to `stop`.

    Args:
        devices: what each is to emulate.
        run: runs commands.
    """

    def __init__(self, devices: Sequence[Device], run: Run = run_command) -> None:
        self._devices, self._run = devices, run
        self._started: list[Device] = []

    def start(self) -> None:
        """Start all or none; raises InputError where the kernel or the rights do not allow it."""
        for device in self._devices:
            with tempfile.TemporaryDirectory(prefix="farhand-tc-") as folder:
                environment = {}
                if device.network.table is not None:
                    (Path(folder) / f"{TABLE}.dist").write_text(device.network.table.text(), encoding="ascii")
                    environment = {"TC_LIB_DIR": folder}
                for command in set_commands(device):
                    code, _, stderr = self._run(command, environment)
                    if code:
                        self.stop()
                        raise refusal(command, stderr)
                    if device not in self._started:
                        self._started.append(device)

    def stop(self) -> None:
        """End what was started; a device that is gone by now is fine."""
        while self._started:
            self._run(remove_command(self._started.pop()), {})

    def counted(self) -> list[str]:
        """One line a device: packets sent and dropped."""
        lines = []
        for device in self._started:
            code, stdout, _ = self._run(
                ["tc", "-s", "-json", "qdisc", "show", "dev", device.name, "root"], {}
            )
            found = json.loads(stdout or "[]") if code == 0 else []
            if found:
                lines.append(
                    f"tc on {device.name}: {found[0].get('packets')} packets, {found[0].get('drops')} dropped"
                )
        return lines


@contextmanager
def kernel_emulation(
    settings: NetemSettings, operator_device: str = "", robot_device: str = "", run: Run = run_command
) -> Iterator[NetemSettings]:
    """Emulate the settings' network in the kernel meanwhile; gives the settings of a proxy that only forwards.

    Args:
        settings: as for netem's own emulation.
        operator_device, robot_device: network devices; empty: those that have the endpoints' addresses.
        run: runs commands.

    Raises:
        InputError: tc-netem cannot do what is asked, or cannot be used here.
    """
    for option, value in (("--timeline", settings.timeline), ("--control", settings.control)):
        if value:
            raise InputError(f"--backend tc: cannot be changed while it runs; leave {option} out")
    uplink = kernel_network(parse_spec(settings.uplink), "uplink")
    downlink = kernel_network(parse_spec(settings.downlink), "downlink")
    operator_device = operator_device or find_device(settings.listen_operator, "--tc-operator", run)
    robot_device = robot_device or find_device(settings.listen_robot, "--tc-robot", run)
    if operator_device == robot_device:
        raise InputError(
            f"--backend tc: both sides are on the device {operator_device}; it takes one for each, in a network apart"
        )
    emulation = KernelEmulation([Device(robot_device, uplink), Device(operator_device, downlink)], run)
    emulation.start()
    try:
        yield msgspec.structs.replace(settings, uplink="none", downlink="none")
        for line in emulation.counted():
            print(f"netem: {line}", file=sys.stderr, flush=True)
    finally:
        emulation.stop()
