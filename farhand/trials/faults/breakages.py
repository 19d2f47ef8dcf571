"""Faults that nobody intends: cables, processes, clocks, readers."""

import signal
from collections.abc import Callable
from dataclasses import dataclass

from farhand.common.errors import FarhandError
from farhand.trials.faults.false_clock import FalseClock, why_no_false_clock
from farhand.trials.faults.rig import Rig
from farhand.trials.hosts import NETEM_FOR_OPERATOR

Step = Callable[[Rig], object]
HOUR = 3600


@dataclass(frozen=True, slots=True)
class Breakage:
    """One fault.

    Attributes:
        run: breaks something, and mends it where it does not mend itself.
        prepare, clean_up: what has to be done before and after, and is not part of it.
        missing: why it cannot be done here, or empty.
        arm_stands: whether nothing commands a robot's arm any more, so that its own controller must have it stand.
    """

    run: Step
    prepare: Step = lambda rig: None
    clean_up: Step = lambda rig: None
    missing: str = ""
    arm_stands: bool = False


def breakages() -> dict[str, Breakage]:
    """All of them by name, in the order in which they are done."""
    found: dict[str, Breakage] = {}
    for host in ("operator", "robot"):
        for seconds in (0.5, 2.0, 10.0):
            found[f"link to the {host} down for {seconds:g} s"] = _unplugged(host, seconds)
    for program in ("operator", "netem", "robot"):
        found[f"{program} frozen for 5 s"] = _frozen(program)
    for program in ("operator", "netem", "robot"):
        found[f"{program} killed, restarted"] = _restarted(program, signal.SIGKILL)
    for program in ("operator", "netem", "robot"):
        found[f"{program} ended, restarted"] = _restarted(program, signal.SIGTERM)
    for program, jump in (("operator", -HOUR), ("netem", HOUR), ("robot", HOUR)):
        found[f"clock of the {program}'s host {jump:+d} s"] = _clock(program, jump)
    found["reader beside the operator stops reading for 5 s"] = Breakage(lambda rig: _reader(rig, ""))
    found["reader beside the operator takes 1 s a message"] = Breakage(lambda rig: _reader(rig, "slow"))
    return found


def _unplugged(host: str, seconds: float) -> Breakage:
    return Breakage(lambda rig: rig.unplugged(host, seconds))


def _frozen(program: str) -> Breakage:
    return Breakage(lambda rig: rig.frozen(program), arm_stands=program == "robot")


def _restarted(program: str, number: signal.Signals) -> Breakage:
    return Breakage(lambda rig: rig.end_and_restart(program, number), arm_stands=program == "robot")


def _clock(program: str, seconds: int) -> Breakage:
    clock = FalseClock(program)

    def jump(rig: Rig) -> None:
        clock.jump(seconds)
        rig.pause(5.0)

    return Breakage(jump, clock.prepare, clock.clean_up, why_no_false_clock())


def _reader(rig: Rig, pace: str) -> None:
    """A subscriber on the operator's side that stops reading for 5 s, or takes 1 s a message for 8 s."""
    reader = rig.start_observer("operator", f"tls/{NETEM_FOR_OPERATOR}:7447", pace)
    assert reader.stdout is not None
    if not reader.stdout.readline():
        raise FarhandError("the reader beside the operator read nothing at all")
    if not pace:
        reader.send_signal(signal.SIGSTOP)
    rig.pause(8.0 if pace else 5.0)
    reader.kill()
    reader.wait()
