"""`farhand netem --backend tc`: the kernel delays and loses packets (tc-netem), the proxy only forwards.

tc-netem acts on what leaves a device: the device on the robot's side carries the uplink, the one on the
operator's side the downlink. What netem measures and reports then holds the kernel's part as the round trip.

A device's queueing discipline that somebody set is not touched but refused. What a killed emulation has left
behind bears HANDLE, and is taken away before the next begins: `tc qdisc replace` would keep parts of it.
"""

import json
import socket
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import msgspec

from farhand.common.errors import InputError
from farhand.common.process.signals import say
from farhand.common.result_file import read_result, write_result
from farhand.netem.measure.result import KernelCounts, NetemResult
from farhand.netem.settings import NetemSettings
from farhand.netem.spec import parse_spec
from farhand.netem.tc.host import HANDLE, Run, claim, find_device, refusal, run_command
from farhand.netem.tc.words import TABLE, KernelNetwork, kernel_network


class Device(NamedTuple):
    """What a network device is to emulate, and which direction goes out there."""

    name: str
    network: KernelNetwork
    direction: str = ""


def set_commands(device: Device) -> list[list[str]]:
    """The commands that start the emulation on a device; none where there is nothing to emulate."""
    if not device.network.arguments:
        return []
    add = ["tc", "qdisc", "add", "dev", device.name, "root", "handle", HANDLE]
    return [[*add, "netem", *device.network.arguments]]


def remove_command(device: Device) -> list[str]:
    """The command that ends the emulation."""
    return ["tc", "qdisc", "del", "dev", device.name, "root"]


class KernelEmulation:
    """tc-netem on some devices, from `start` to `stop`.

    Args:
        devices: what each is to emulate.
        run: runs commands.
    """

    def __init__(self, devices: Sequence[Device], run: Run = run_command) -> None:
        self._devices, self._run = devices, run
        self._started: list[Device] = []
        self._claims: list[socket.socket] = []

    def start(self) -> list[str]:
        """Start all or none; returns a line for each device on which something had been left behind.

        Raises InputError where the kernel or the rights do not allow it, or the device is taken.
        """
        try:
            return [line for device in self._devices for line in self._start(device)]
        except BaseException:
            self.stop()
            raise

    def stop(self) -> None:
        """End what was started; a device that is gone by now is fine."""
        while self._started:
            self._run(remove_command(self._started.pop()), {})
        while self._claims:
            self._claims.pop().close()

    def counted(self) -> list[KernelCounts]:
        """What each device sent and dropped, in packets; without those that are gone."""
        found = []
        for device in self._started:
            try:
                root = self._root(device)
            except InputError:
                continue
            packets, dropped = root.get("packets", 0), root.get("drops", 0)
            found.append(
                KernelCounts(device=device.name, direction=device.direction, packets=packets, dropped=dropped)
            )
        return found

    def _start(self, device: Device) -> list[str]:
        self._claims.append(claim(device.name))
        root, said = self._root(device), []
        if root.get("handle") == HANDLE:
            self._do(remove_command(device))
            said = [f"tc on {device.name}: took away what an emulation that was killed had left there"]
        elif root.get("handle", "0:") != "0:":
            raise InputError(
                f"--backend tc: the device {device.name} has a queueing discipline already "
                f"({root.get('kind')} {root['handle']}); remove it: {' '.join(remove_command(device))}"
            )
        with tempfile.TemporaryDirectory(prefix="farhand-tc-") as folder:
            environment = {}
            if device.network.table is not None:
                (Path(folder) / f"{TABLE}.dist").write_text(device.network.table.text(), encoding="ascii")
                environment = {"TC_LIB_DIR": folder}
            for command in set_commands(device):
                self._do(command, environment)
                self._started.append(device)
        return said

    def _do(self, command: Sequence[str], environment: Mapping[str, str] = MappingProxyType({})) -> str:
        code, stdout, stderr = self._run(command, environment)
        if code:
            raise refusal(command, stderr)
        return stdout

    def _root(self, device: Device) -> dict[str, Any]:
        shown = self._do(["tc", "-s", "-json", "qdisc", "show", "dev", device.name, "root"])
        found: list[dict[str, Any]] = json.loads(shown or "[]")
        return found[0] if found else {}


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
    if settings.robot_networks:
        raise InputError("--backend tc: tells no robots apart; leave --robot-network out")
    uplink = kernel_network(parse_spec(settings.uplink), "uplink")
    downlink = kernel_network(parse_spec(settings.downlink), "downlink")
    operator_device = operator_device or find_device(settings.listen_operator, "--tc-operator")
    robot_device = robot_device or find_device(settings.listen_robot, "--tc-robot")
    if operator_device == robot_device:
        raise InputError(
            f"--backend tc: both sides are on the device {operator_device}; it takes one for each, in a network apart"
        )
    emulation = KernelEmulation(
        [Device(robot_device, uplink, "uplink"), Device(operator_device, downlink, "downlink")], run
    )
    for line in emulation.start():
        say("netem", line)
    try:
        yield msgspec.structs.replace(settings, uplink="none", downlink="none")
        counted = emulation.counted()
        for each in counted:
            say("netem", f"tc on {each.device}: {each.packets} packets, {each.dropped} dropped")
        if settings.stats:
            _append(Path(settings.stats), counted)
    finally:
        emulation.stop()


def _append(stats: Path, counted: list[KernelCounts]) -> None:
    """Put the kernel's counts beside the proxy's."""
    statistics = read_result(stats, NetemResult)
    if statistics is not None:
        write_result(msgspec.structs.replace(statistics, tc=counted), stats)
