"""The faults one after the other: how long the arm moves on, what is said, and that it waits for an acknowledgement."""

import json
import signal
import tempfile
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

from rich.table import Table

from farhand.common.errors import FarhandError
from farhand.common.process.console import page, whole
from farhand.common.process.signals import say
from farhand.robot_side.ur.errands import send_program
from farhand.trials.ur.rig import Rig

MOVED = 1e-3
"""rad, below which a joint has not moved."""
WAITS = 1.0
"""s for which the hand asks in vain before it acknowledges."""
SETTLES = 1.5
"""s, after which it is known what it was: remote control is asked for once a second."""
SILENT = 0.6
"""s, within which it shall stand where nobody commands: safety.command_timeout, and braking."""
ENOUGH = 0.2
"""s, within which the arm shall stand."""
OTHER = "def other():\n  while True:\n    sync()\n  end\nend\n"


@dataclass(frozen=True, slots=True, kw_only=True)
class Fault:
    """Attributes:
    name: for people.
    strikes: makes it happen.
    clears: takes it back.
    recovers: whether `farhand ur recover` is needed afterwards.
    within: the arm shall stand (s).
    """

    name: str
    strikes: Callable[[Rig], object]
    clears: Callable[[Rig], object] = lambda rig: None
    recovers: bool = False
    within: float = ENOUGH


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """Attributes:
    fault: its name.
    standstill: from the fault until the arm stood (s).
    reason: why the robot said that it stopped; empty: it said nothing, as one that is dead.
    moved: how far a joint moved before the acknowledgement, once the fault was cleared (rad).
    drives: whether it moved again after the acknowledgement.
    within: it shall have stood (s).
    """

    fault: str
    standstill: float
    reason: str
    moved: float
    drives: bool
    within: float = ENOUGH

    @property
    def good(self) -> bool:
        """Whether it stood in time, waited, and went on."""
        return self.standstill <= self.within and self.moved <= MOVED and self.drives


def _command(line: str) -> Callable[[Rig], object]:
    return lambda rig: rig.fault(line)


def _killed(rig: Rig) -> None:
    rig.signal(signal.SIGKILL)
    rig.programs["robot"].wait()


def _ended(rig: Rig) -> None:
    rig.signal(signal.SIGINT)
    rig.programs["robot"].wait()


def _thawed(rig: Rig) -> None:
    rig.pause(2.0)
    rig.programs["robot"].send_signal(signal.SIGCONT)


def _plugged(rig: Rig) -> None:
    rig.pause(2.0)
    rig.fault("plug")


def _booted(rig: Rig) -> None:
    rig.pause(3.5)


def _silenced(rig: Rig) -> None:
    assert rig.hand is not None
    rig.fault("mark")
    rig.hand.silent = True


def _heard_again(rig: Rig) -> None:
    assert rig.hand is not None
    rig.hand.silent = False


def _emergency(rig: Rig) -> None:
    assert rig.hand is not None
    rig.fault("mark")
    rig.hand.stop()


def _other_program(rig: Rig) -> None:
    rig.fault("mark")
    send_program(rig.address, OTHER)


FAULTS = (
    Fault(name="robot program: Ctrl-C", strikes=_ended, clears=lambda rig: rig.start_robot()),
    Fault(name="robot program: kill -9", strikes=_killed, clears=lambda rig: rig.start_robot()),
    Fault(
        name="robot program: SIGSTOP for 2 s",
        strikes=lambda rig: rig.signal(signal.SIGSTOP),
        clears=_thawed,
    ),
    Fault(name="operator falls silent", strikes=_silenced, clears=_heard_again, within=SILENT),
    Fault(name="operator's emergency stop", strikes=_emergency),
    Fault(
        name="cable out for 2 s",
        strikes=_command("cut"),
        clears=_plugged,
    ),
    Fault(
        name="controller starts anew",
        strikes=_command("restart"),
        clears=_booted,
        recovers=True,
    ),
    Fault(name="protective stop", strikes=_command("protective-stop"), recovers=True),
    Fault(
        name="emergency stop at the arm",
        strikes=_command("estop"),
        clears=_command("estop-release"),
        recovers=True,
    ),
    Fault(
        name="safeguard opens",
        strikes=_command("safeguard-open"),
        clears=_command("safeguard-close"),
        recovers=True,
    ),
    Fault(name="freedrive", strikes=_command("freedrive"), clears=_command("freedrive-end"), recovers=True),
    Fault(name="local mode at the pendant", strikes=_command("local"), clears=_command("remote")),
    Fault(name="pause at the pendant", strikes=_command("pause"), recovers=True),
    Fault(name="pause, then play", strikes=_command("pause"), clears=_command("play")),
    Fault(name="stop at the pendant", strikes=_command("stop")),
    Fault(name="another client's program", strikes=_other_program, clears=_command("stop")),
    Fault(name="power off", strikes=_command("power-off"), recovers=True),
    Fault(name="speed slider to 10 %", strikes=_command("slider 0.1"), clears=_command("slider 1")),
    Fault(name="speed slider to 0", strikes=_command("slider 0"), clears=_command("slider 1")),
    Fault(name="another payload at the pendant", strikes=_command("payload 2")),
    Fault(
        name="cable's latency to 0.15 s each way",
        strikes=_command("latency 0.15"),
        clears=_command("latency 0"),
    ),
)


def strike(rig: Rig, fault: Fault) -> Outcome:
    """One fault, while the arm moves."""
    rig.drive()
    fault.strikes(rig)
    rig.wait_for_stand()
    standstill = float(rig.fault("standstill").split()[0])
    rig.pause(SETTLES)
    reason = rig.reason() if rig.mode() in ("stopped", "estop") else ""
    fault.clears(rig)
    if fault.recovers:
        rig.farhand("ur", "recover", "--host", rig.address, "--yes")
    rig.pause(0.3)
    before = rig.joints()
    rig.pause(WAITS)
    moved = max(abs(a - b) for a, b in zip(before, rig.joints(), strict=True))
    try:
        rig.drive()
        drives = True
    except FarhandError as error:
        say("trial", f"{fault.name}: {error}")
        drives = False
    return Outcome(
        fault=fault.name,
        standstill=standstill,
        reason=reason,
        moved=moved,
        drives=drives,
        within=fault.within,
    )


def run_ur_trial(address: str, rate_hz: float, names: tuple[str, ...], as_json: bool) -> int:
    """All faults, or those whose name has one of `names` in it; returns 0 where all are good, else 1."""
    outcomes: list[Outcome] = []
    with tempfile.TemporaryDirectory(prefix="farhand-ur-") as folder:
        rig = Rig(Path(folder), address, rate_hz)
        try:
            for fault in FAULTS:
                if not names or any(name in fault.name for name in names):
                    outcomes.append(strike(rig, fault))
                    judged = "good" if outcomes[-1].good else "NOT GOOD"
                    say("trial", f"{fault.name}: stood after {outcomes[-1].standstill:.3f} s, {judged}")
        finally:
            rig.close()
    if as_json:
        print(json.dumps([asdict(outcome) for outcome in outcomes]))
    else:
        table = Table(
            title=f"a UR arm in the emulator, {rate_hz:g} Hz, the tool at 0.2 m/s", title_justify="left"
        )
        for column in ("fault", "stands after (s)", "what the robot says", "moved before", "drives again"):
            table.add_column(column, overflow="fold")
        for each in outcomes:
            moved = "no" if each.moved <= MOVED else f"{each.moved:.3f} rad"
            stood = f"{each.standstill:.3f}"
            table.add_row(each.fault, stood, each.reason, moved, "yes" if each.drives else "NO")
        console = page()
        console.print(whole(table, console))
    return 0 if all(outcome.good for outcome in outcomes) else 1
