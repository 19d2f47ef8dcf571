"""`farhand ur recover`: from whatever stopped a UR arm back to one that can be driven. It moves nothing itself.

What only somebody at the arm can do is said, and waited for; what the network may do is done after a question.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from farhand.common.process.signals import say
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.robot_side.ur.dashboard import Dashboard, DashboardError, is_remote
from farhand.robot_side.ur.program import RUN
from farhand.robot_side.ur.rtde_client import RtdeClient, Wanted
from farhand.robot_side.ur.states import (
    BACKDRIVE,
    FREED_BIT,
    NORMAL,
    OPTIONAL,
    OUTPUTS,
    PAUSED,
    PLAYING,
    PROTECTIVE_STOP,
    REDUCED,
    ROBOT_MODES,
    RUNNING,
    SAFEGUARD,
    SAFETY_MODES,
    Facts,
)

LOOK_EVERY = 0.1
BETWEEN = 1.0
"""s between two tries of the same."""
NEVER_HEARD = 30.0
"""s without a word from an address from which none came before: nothing boots there that was stopped."""
POWER_OFF, POWER_ON, IDLE = 3, 4, 5
POWERING = ("power on", "brake release")


@dataclass(frozen=True, slots=True)
class Step:
    """What is next.

    Attributes:
        kind: `done`; `wait` for somebody at the arm; `do` it over the dashboard.
        said: for people.
        command: of the dashboard, with `do`.
        asks: whether a person is asked before, since they must have looked at the arm.
    """

    kind: Literal["done", "wait", "do"]
    said: str
    command: str = ""
    asks: bool = False


def next_step(facts: Facts) -> Step:
    """What brings the arm nearer to being driven; pure."""
    values = facts.values
    safety, mode = int(values["safety_mode"]), int(values["robot_mode"])
    if facts.remote is False:
        return Step("wait", "local mode: choose remote control at the pendant")
    if safety not in (NORMAL, REDUCED):
        return _out_of(safety)
    if mode == BACKDRIVE or int(values["robot_status_bits"]) & FREED_BIT:
        return Step("wait", "freedrive: let go of the button")
    if mode in (POWER_OFF, POWER_ON, IDLE):
        said = f"{ROBOT_MODES[mode]}: power on, release of the brakes; the arm may sink by a hair"
        return Step("do", said, "brake release" if mode == IDLE else "power on", asks=mode != POWER_ON)
    if mode != RUNNING:
        return Step("wait", f"{ROBOT_MODES.get(mode, f'robot mode {mode}')}: until it is over")
    if int(values["runtime_state"]) == PAUSED:
        return Step("do", "the paused program is ended: a stopped one must start anew", "stop")
    return _running(values)


def _out_of(safety: int) -> Step:
    if safety == PROTECTIVE_STOP:
        said = (
            "protective stop: is the arm free, the cause known? it is unlocked 5 s after the stop, not before"
        )
        return Step("do", said, "unlock protective stop", asks=True)
    if safety == SAFEGUARD:
        return Step("wait", "safeguard stop: close the safeguard")
    return Step("wait", f"{SAFETY_MODES.get(safety, f'safety mode {safety}')}: clear it at the arm")


def _running(values: dict[str, object]) -> Step:
    if float(str(values["target_speed_fraction"])) <= 0.0:
        return Step("wait", "speed slider at 0: move it up")
    plays = int(str(values["runtime_state"])) == PLAYING
    if plays and not int(str(values[RUN])):
        return Step("wait", "another program runs: end it at the pendant, or whoever runs it")
    return Step("done", "ready")


def run_recover(host: str, patience: float, confirm: Callable[[], bool]) -> int:
    """Walk through what clears the arm; returns 0 once it can be driven, else 1.

    Args:
        host: address of the controller.
        patience: how long is waited for somebody at the arm (s).
        confirm: asks a person; False ends it.
    """
    client, clock = RtdeClient(host, Wanted(OUTPUTS, OPTIONAL)), SystemClock()
    try:
        return _walk(client, host, clock, patience, confirm)
    except DashboardError as error:
        say("ur recover", str(error))
        return 1
    finally:
        client.close()


def _walk(
    client: RtdeClient, host: str, clock: SystemClock, patience: float, confirm: Callable[[], bool]
) -> int:
    said, confirmed = "", set[str]()
    since_ns, tried_ns, heard = clock.now_ns(), 0, False
    while True:
        facts = _look(client, host, clock)
        heard = heard or facts is not None
        within = patience if heard else min(patience, NEVER_HEARD)
        lost = Step("wait", f"no connection to the controller: {client.trouble}; waiting for it")
        step = lost if facts is None else next_step(facts)
        if step.said != said:
            said = step.said
            say("ur recover", step.said)
            since_ns = clock.now_ns() if heard else since_ns
        if step.kind == "done":
            say(
                "ur recover",
                "Farhand's program starts anew by itself; the arm moves after an acknowledgement of the operator",
            )
            return 0
        now_ns = clock.now_ns()
        if now_ns - since_ns > to_ns(within):
            say("ur recover", f"given up after {within:g} s; farhand ur check --host {host} looks closer")
            return 1
        if step.kind == "do":
            about = "power" if step.command in POWERING else step.command
            if step.asks and about not in confirmed:
                if not confirm():
                    say("ur recover", "not confirmed: nothing was done; --yes says it beforehand")
                    return 1
                confirmed.add(about)
            if now_ns - tried_ns > to_ns(BETWEEN):
                tried_ns = now_ns
                _do(host, step.command)
        clock.sleep_until(clock.now_ns() + to_ns(LOOK_EVERY))


def _do(host: str, command: str) -> None:
    with Dashboard(host) as dashboard:
        said = dashboard.ask(command)
        if command == "unlock protective stop":
            dashboard.ask("close safety popup")
    if "not allowed" in said:
        say("ur recover", said)


def _look(client: RtdeClient, host: str, clock: SystemClock) -> Facts | None:
    """A state that is new; None where there is no connection."""
    end_ns = clock.now_ns() + to_ns(2.0)
    while clock.now_ns() < end_ns:
        now_ns = clock.now_ns()
        if client.poll(now_ns) and not client.trouble:
            return Facts(client.values, 0.0, remote=_remote(host))
        clock.sleep_until(now_ns + to_ns(0.002))
    return None


def _remote(host: str) -> bool | None:
    try:
        return is_remote(host)
    except DashboardError:
        return None
