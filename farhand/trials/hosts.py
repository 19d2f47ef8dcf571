"""Three hosts on one machine: network namespaces for operator, netem and robot, joined by two cables."""

import itertools
import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

from farhand.common.process.signals import PARENT_VARIABLE

HOSTS = ("operator", "netem", "robot")
NETEM_FOR_OPERATOR, NETEM_FOR_ROBOT = "10.81.1.1", "10.81.2.1"
OPERATOR, ROBOT = "10.81.1.2", "10.81.2.2"
_ADDRESSES = {"operator": (OPERATOR, NETEM_FOR_OPERATOR), "robot": (ROBOT, NETEM_FOR_ROBOT)}


_numbers = itertools.count()


def why_not() -> str:
    """Why namespaces cannot be made here, or an empty string."""
    if os.geteuid() != 0:
        return "needs root for network namespaces"
    if shutil.which("ip") is None:
        return "needs the `ip` command (iproute2)"
    made = subprocess.run(["ip", "netns", "add", f"fh{os.getpid()}try"], capture_output=True, text=True)
    if made.returncode:
        return f"cannot make network namespaces: {made.stderr.strip()}"
    subprocess.run(["ip", "netns", "del", f"fh{os.getpid()}try"], check=False)
    return ""


class Hosts:
    """The namespaces and what runs in them; `close` ends and removes all of it.

    Forwarding is off in netem's namespace, so operator and robot can meet only through its programs.
    """

    def __init__(self) -> None:
        own = f"fh{os.getpid()}.{next(_numbers)}"
        self._names = {host: f"{own}.{host}" for host in HOSTS}
        self._running: list[subprocess.Popen[str]] = []
        try:
            for name in self._names.values():
                _ip("netns", "add", name)
                _ip("-n", name, "link", "set", "lo", "up")
            for host, (own, other) in _ADDRESSES.items():
                near, far = self._names[host], self._names["netem"]
                _ip(
                    "-n",
                    near,
                    "link",
                    "add",
                    "cable",
                    "type",
                    "veth",
                    "peer",
                    "name",
                    f"to-{host}",
                    "netns",
                    far,
                )
                for place, device, address in ((near, "cable", own), (far, f"to-{host}", other)):
                    _ip("-n", place, "addr", "add", f"{address}/24", "dev", device)
                    _ip("-n", place, "link", "set", device, "up")
        except BaseException:
            self.close()
            raise

    def start(
        self,
        host: str,
        *module_and_arguments: str,
        log: Path | None = None,
        environment: Mapping[str, str] | None = None,
        told: bool = False,
    ) -> subprocess.Popen[str]:
        """Run a Python module on a host; its output is a pipe, or goes to the log, and with `told` its input is one."""
        command = self.command_on(host, sys.executable, "-m", *module_and_arguments)
        out = log.open("a") if log is not None else None
        try:
            process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE if told else subprocess.DEVNULL,
                stdout=out or subprocess.PIPE,
                stderr=out or subprocess.DEVNULL,
                text=True,
                env={**os.environ, **(environment or {}), PARENT_VARIABLE: str(os.getpid())},
            )
        finally:
            if out is not None:
                out.close()
        self._running.append(process)
        return process

    def namespace(self, host: str) -> str:
        """Name of a host's network namespace."""
        return self._names[host]

    def command_on(self, host: str, *command: str) -> list[str]:
        """A command such that it runs on a host."""
        return ["ip", "netns", "exec", self._names[host], *command]

    def plug(self, host: str, up: bool) -> None:
        """Plug a host's cable in or out, at netem's end."""
        _ip("-n", self._names["netem"], "link", "set", f"to-{host}", "up" if up else "down")

    def listening(self, host: str) -> list[str]:
        """ADDRESS:PORT of everything on a host that accepts connections."""
        command = ["ip", "netns", "exec", self._names[host], "ss", "-Hltn"]
        done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=20)
        return [line.split()[3] for line in done.stdout.splitlines()]

    def close(self) -> None:
        """End what was started here and remove the namespaces."""
        for process in self._running:
            if process.poll() is None:
                process.kill()
            process.wait()
            for pipe in (process.stdin, process.stdout):
                if pipe is not None:
                    pipe.close()
        for name in self._names.values():
            subprocess.run(["ip", "netns", "del", name], capture_output=True, check=False)


def _ip(*arguments: str) -> None:
    subprocess.run(["ip", *arguments], check=True, capture_output=True, timeout=20)
