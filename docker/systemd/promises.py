"""What the units promise, tried inside of the container that try.sh boots: `promises.py first|boot`.

Moments are systemd's own, in microseconds since the machine started, which is also what /proc/uptime counts.
"""

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

FARHAND = "/opt/farhand/bin/farhand"
SETTINGS, AUTHORITY = Path("/etc/farhand"), Path("/root/ca")
ROBOT, NETEM = "farhand-robot", "farhand-netem"


def run(*command: str) -> str:
    """What a command prints; raises CalledProcessError where it fails."""
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()


def show(unit: str, what: str) -> str:
    """A property of a unit, or of systemd itself."""
    return run("systemctl", "show", "-P", what, *([unit] if unit else []))


def moment(unit: str, what: str) -> float:
    """When something last happened to a unit (s)."""
    return int(show(unit, f"{what}TimestampMonotonic")) / 1e6


def now() -> float:
    """Seconds since the machine started."""
    return float(Path("/proc/uptime").read_text(encoding="ascii").split()[0])


def wait_for(what: str, condition: Callable[[], bool], patience: float = 60.0) -> None:
    """Wait until a condition holds; ends the program where it does not."""
    pause, until = threading.Event(), now() + patience
    while not condition():
        if now() > until:
            sys.exit(
                f"NOT KEPT: {what} did not happen in {patience:g} s\n{run('systemctl', 'status', ROBOT, NETEM)}"
            )
        pause.wait(0.05)


def journal(unit: str) -> str:
    """What a unit said since the machine started."""
    return run("journalctl", "--no-pager", "--boot", "--output", "cat", "--unit", unit)


def process(unit: str) -> int:
    """The process of a unit that runs and is ready, else 0."""
    shown = run("systemctl", "show", "-p", "ActiveState", "-p", "MainPID", unit)
    found = dict(line.split("=", 1) for line in shown.splitlines())
    return int(found["MainPID"]) if found["ActiveState"] == "active" else 0


def wait_for_process(unit: str, other_than: int = 0) -> int:
    """Wait until a unit runs and is ready, by another process than an earlier one; returns the process."""
    wait_for(f"{unit} ready", lambda: process(unit) not in (0, other_than))
    return process(unit)


def hurt(unit: str, number: signal.Signals) -> None:
    """Send a unit's program a signal, and say when it was there again."""
    old, then = wait_for_process(unit), now()
    os.kill(old, number)
    wait_for_process(unit, other_than=old)
    started, ready = moment(unit, "ExecMainStart") - then, moment(unit, "ActiveEnter") - then
    print(f"{unit}: {number.name}: started anew after {started:.2f} s, ready after {ready:.2f} s")


def alone() -> None:
    """A robot is ready without netem, and found by it later."""
    run("systemctl", "stop", NETEM)
    run("systemctl", "restart", ROBOT)
    print(f"{ROBOT}: without netem: {show(ROBOT, 'ActiveState')}, {show(ROBOT, 'SubState')}")
    run("systemctl", "start", NETEM)


def without_certificates() -> None:
    """A missing folder is told in one line, and the program goes on trying."""
    wait_for("a second try", lambda: all(int(show(unit, "NRestarts")) >= 2 for unit in (ROBOT, NETEM)))
    for unit in (ROBOT, NETEM):
        print(f"{unit}: {next(line for line in journal(unit).splitlines() if line.startswith('farhand:'))}")
        if "Traceback" in journal(unit):
            sys.exit(f"NOT KEPT: {unit} says more than a line:\n{journal(unit)}")


def issue() -> None:
    """Certificates, readable by the user farhand alone."""
    run(FARHAND, "certs", "init", "--dir", str(AUTHORITY))
    for role, name, more in (
        ("netem", "gate", ["--host", "localhost"]),
        ("robot", "ur5", []),
        ("operator", "operator", ["--robot", "ur5"]),
    ):
        run(FARHAND, "certs", "issue", role, name, *more, "--dir", str(AUTHORITY))
    for name in ("netem.gate", "robot.ur5"):
        run("cp", "-R", str(AUTHORITY / name), str(SETTINGS))
        run("chown", "-R", "farhand:", str(SETTINGS / name))


def rights() -> None:
    """What the robot's program may do."""
    place = Path("/proc", str(process(ROBOT)))
    status = dict(line.split(":\t", 1) for line in (place / "status").read_text().splitlines())
    limit = next(line for line in (place / "limits").read_text().splitlines() if "realtime priority" in line)
    policies = {os.sched_getscheduler(int(path.name)) for path in (place / "task").iterdir()}
    fifo = "some" if os.SCHED_FIFO in policies else "none"
    print(f"rights: capabilities {status['CapEff']}, no new privileges {status['NoNewPrivs'].strip()},")
    print(f"        real-time priority up to {limit.split()[3]}, threads under SCHED_FIFO: {fifo}")


def drive() -> None:
    """One task, through netem, by an operator on the same machine."""
    tls = ["--tls", str(AUTHORITY / "operator.operator")]
    command = [FARHAND, "operator", "--connect", "tls/localhost:7447", *tls, "--time-limit", "60"]
    code = subprocess.run(command, check=False, timeout=120).returncode
    print(f"operator: exit code {code}")
    if code:
        sys.exit("NOT KEPT: the task was not finished")


def first() -> None:
    """All of it, from a machine without certificates."""
    without_certificates()
    issue()
    for unit in (NETEM, ROBOT):
        wait_for_process(unit)
    print(
        f"{ROBOT}: ready {moment(ROBOT, 'ActiveEnter') - moment(ROBOT, 'ExecMainStart'):.2f} s after its start"
    )
    rights()
    drive()
    hurt(ROBOT, signal.SIGKILL)
    hurt(ROBOT, signal.SIGSTOP)
    if "Watchdog timeout" not in journal(ROBOT):
        sys.exit("NOT KEPT: the watchdog did not end the robot's program")
    hurt(NETEM, signal.SIGKILL)
    alone()
    drive()


def boot() -> None:
    """After a restart of the machine."""
    for unit in (NETEM, ROBOT):
        wait_for_process(unit)
        print(f"{unit}: ready {moment(unit, 'ActiveEnter') - moment('', 'Userspace'):.2f} s after boot")
    drive()


if __name__ == "__main__":
    wait_for("systemd answers", Path("/run/systemd/private").exists)
    {"first": first, "boot": boot}[sys.argv[1]]()
