"""What keeps a UR arm from being driven, told from what its controller says; pure."""

import re
from dataclasses import dataclass
from typing import Any

from farhand.robot_side.ur.program import AS_TOLD, BY_DEADLINE, ENDED, HEARD, LIMITS, RUN

ROBOT_MODES = {
    -1: "no controller", 0: "disconnected", 1: "to be confirmed", 2: "booting", 3: "power off", 4: "power on",
    5: "idle, its brakes closed", 6: "freedrive", 7: "running", 8: "updating its firmware",
}  # fmt: skip
SAFETY_MODES = {
    1: "normal", 2: "reduced", 3: "protective stop", 4: "recovery", 5: "safeguard stop", 6: "emergency stop",
    7: "emergency stop", 8: "safety violation", 9: "safety fault", 10: "to be validated", 11: "not yet known",
}  # fmt: skip
RUNNING, BACKDRIVE = 7, 6
NORMAL, REDUCED, PROTECTIVE_STOP, SAFEGUARD = 1, 2, 3, 5
STOPPED, PLAYING, PAUSED = 1, 2, 4
FREED_BIT = 1 << 2  # of robot_status_bits: the button behind the pendant is pressed
STALE = 0.1
"""s without a state, or without an answer of the program, from which the arm cannot be driven."""
FULL = 0.995
"""Speed scaling from which on nothing is said of it."""

OUTPUTS = (
    "timestamp", "actual_q", "actual_qd", "robot_mode", "safety_mode", "runtime_state", "robot_status_bits",
    "speed_scaling", "target_speed_fraction", HEARD, RUN, ENDED, LIMITS, "payload", "payload_cog", "tcp_offset",
    "actual_TCP_pose",
)  # fmt: skip
OPTIONAL = ("payload", "payload_cog", "tcp_offset")


@dataclass(frozen=True, slots=True)
class Facts:
    """What is known at one instant.

    Attributes:
        values: RTDE's newest outputs, by name; empty before the first.
        age: of them (s).
        trouble: why there is no connection; empty: there is one.
        remote: whether the controller may be controlled from elsewhere; None: it has no such mode, or nobody knows.
        run: number of our program's run; 0: none was started.
        answer_age: for how long the program has answered no message (s).
        unsent: why the program could not be sent to the controller; empty: it could, or was not yet.
    """

    values: dict[str, Any]
    age: float
    trouble: str = ""
    remote: bool | None = None
    run: int = 0
    answer_age: float = 0.0
    unsent: str = ""


def blocked(facts: Facts) -> str:
    """Why not even a program can be run, and what to do; empty: nothing keeps it."""
    lost = _lost(facts)
    if lost:
        return lost
    values = facts.values
    safety, mode = int(values["safety_mode"]), int(values["robot_mode"])
    if safety not in (NORMAL, REDUCED):
        return f"{SAFETY_MODES.get(safety, f'safety mode {safety}')}: {_way_out(safety)}"
    if mode == BACKDRIVE or int(values["robot_status_bits"]) & FREED_BIT:
        return "freedrive: somebody leads the arm by hand"
    if mode != RUNNING:
        return f"{ROBOT_MODES.get(mode, f'robot mode {mode}')}: farhand ur recover powers it on"
    if facts.remote is False:
        return "local mode: give control to the network at the pendant (remote control)"
    return ""


def unready(facts: Facts) -> str:
    """Why it cannot be driven now, and what to do; empty: our program runs and answers."""
    why = blocked(facts)
    if why:
        return why
    values = facts.values
    runtime, ours = int(values["runtime_state"]), facts.run != 0 and int(values[RUN]) == facts.run
    if runtime == PAUSED:
        return "the program is paused: farhand ur recover ends it, and it starts anew"
    if runtime == PLAYING and not ours:
        return "another program runs on the controller: it is not Farhand's, and is not ended by it"
    if not ours or runtime != PLAYING:
        return facts.unsent or _ended(int(values[ENDED]))
    if float(values["target_speed_fraction"]) <= 0.0:
        return "speed slider at 0: move it up at the pendant"
    if facts.answer_age > STALE:
        return f"Farhand's program on the controller has been silent for {facts.answer_age:.1f} s: is it another's now?"
    return ""


def again(was: str) -> str:
    """What is said once it can be driven again; empty where nothing stopped it.

    A stop has other words from then on, so that whoever acknowledged it in vain before is not taken at that word now.

    Args:
        was: why it could not be driven.
    """
    what = re.split("[:;] ", was)[0]  # without what to do
    return f"ready again, acknowledge to drive; until now: {what}" if was else ""


def may_start(facts: Facts) -> bool:
    """Whether our program may be started now: nothing blocks, and nobody's runs or is paused."""
    return not blocked(facts) and int(facts.values["runtime_state"]) == STOPPED


def slowed(values: dict[str, Any]) -> str:
    """What speed scaling does to a command; empty where it is full."""
    fraction = float(values.get("target_speed_fraction", 1.0))
    if fraction >= FULL:
        return ""
    return f"speed scaling {fraction:.0%}"


def _lost(facts: Facts) -> str:
    if facts.trouble:
        return f"no connection to the controller: {facts.trouble}"
    if not facts.values or facts.age > STALE:
        return "no state from the controller: the cable, or the controller itself"
    return ""


def _ended(code: int) -> str:
    if code == BY_DEADLINE:
        return "the arm was stopped by its own program, which had heard nothing in time; it starts anew"
    return "Farhand's program does not run on the controller" if code != AS_TOLD else "its program was ended"


def _way_out(safety: int) -> str:
    if safety == PROTECTIVE_STOP:
        return "look why, then farhand ur recover"
    if safety == SAFEGUARD:
        return "close the safeguard, then farhand ur recover"
    return "clear it at the arm, then farhand ur recover"
