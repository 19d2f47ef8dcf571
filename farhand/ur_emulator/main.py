"""The program `farhand ur emulator`."""

import ipaddress
import queue
import sys
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from farhand.common.errors import InputError
from farhand.common.geometry import Array
from farhand.common.process.signals import stop_event_on_signals
from farhand.common.process.teller import Teller
from farhand.common.timing.clock import SystemClock
from farhand.common.timing.loop import RealtimeLoop
from farhand.robot_side.arm.model import ArmModel, model
from farhand.ur_emulator.controller import Controller
from farhand.ur_emulator.emulator import Emulator, Ports
from farhand.ur_emulator.models import E_SERIES, SLOWEST, EmulatedModel

SERIAL = "20260000001"


@dataclass(frozen=True, slots=True, kw_only=True)
class EmulatorOptions:
    """What `farhand ur emulator` is asked for.

    Attributes:
        model: which arm and controller.
        arm: in place of the model's, where it is known by its files.
        address: of loopback, where it listens; several emulators have several.
        joints: where the arm stands (rad); None: at the model's home.
        rate_hz: cycles a second; None: the model's own.
        then: fault commands, done at once in order; `after SECONDS COMMAND` does one later.
        local: it begins in local mode.
        fault_port: where it takes fault commands.
        realtime: ask for SCHED_FIFO.
    """

    model: EmulatedModel
    arm: ArmModel | None = None
    address: str = "127.0.0.1"
    joints: tuple[float, ...] | None = None
    rate_hz: float | None = None
    then: Sequence[str] = field(default=())
    local: bool = False
    fault_port: int = 29900
    realtime: bool = True


def emulator_program(options: EmulatorOptions) -> int:
    """Run until it is told to end. Raises InputError for what cannot be used."""
    check_loopback(options.address)
    arm = options.arm or model(options.model.arm)
    q = start_of(arm, options.joints)
    stop_event, clock = stop_event_on_signals(), SystemClock()
    teller = Teller("ur emulator")
    commands: queue.SimpleQueue[str] = queue.SimpleQueue()
    rate = options.rate_hz or options.model.rate_hz
    version = options.model.version if rate <= SLOWEST else E_SERIES
    controller = Controller(arm, q, rate, version, teller.say)
    controller.remote = not options.local
    emulator = Emulator(
        controller,
        options.address,
        Ports(faults=options.fault_port),
        SERIAL,
        options.model.title,
        lambda: _waiting(commands),
    )
    try:
        for line in options.then:
            emulator.faults.check(line)
        software = ".".join(map(str, version[:2]))
        teller.say(
            f"{options.model.title} with software {software}, {rate:g} Hz, at {options.address}; faults on this "
            "terminal: help says which; Ctrl-C ends it"
        )
        for line in options.then:
            commands.put(line)
        _read_terminal(commands.put)
        RealtimeLoop(emulator, clock, realtime=options.realtime, until=lambda _: stop_event.is_set()).run()
    finally:
        emulator.close()
        teller.close()
    return 0


def check_loopback(address: str) -> None:
    """Raise InputError where an address is not of this host alone: nobody else shall command the emulator."""
    try:
        loopback = ipaddress.ip_address(address).is_loopback and ":" not in address
    except ValueError:
        loopback = False
    if not loopback:
        raise InputError(f"--address {address!r}: the emulator listens on loopback only, such as 127.0.0.2")


def start_of(arm: ArmModel, joints: tuple[float, ...] | None) -> Array:
    """Where the arm stands at the start (n,); raises InputError."""
    if joints is None:
        return arm.home
    if len(joints) != arm.n:
        raise InputError(f"--joints: the {arm.title} has {arm.n} joints, not {len(joints)}")
    return np.array(joints)


def _waiting(commands: "queue.SimpleQueue[str]") -> list[str]:
    return [commands.get_nowait()] if not commands.empty() else []


def _read_terminal(take: Callable[[str], None]) -> None:
    """Take lines of standard input in a thread of its own, until it ends."""

    def read() -> None:
        for line in sys.stdin:
            if line.strip():
                take(line)

    threading.Thread(target=read, name="terminal", daemon=True).start()
