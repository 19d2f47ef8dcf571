"""`python -m farhand.faults.runner`: every fault in turn, one table, exit code 1 if any row is unsafe."""

import argparse
import re
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from rich.console import Console
from rich.table import Table

from common.clock import SystemClock, to_ns
from common.errors import FarhandError
from common.scenario import load_scenario
from farhand.certificates import issue, make_authority
from farhand.faults.hosts import NETEM_FOR_OPERATOR, NETEM_FOR_ROBOT, Hosts, why_not
from farhand.faults.watching import MOVING, Outcome, Watcher, judge

ROBOT = "point"
PATIENCE = 30.0
AFTER = 1.0
NETWORK = "constant:20"


class Rig:
    """The three programs on three hosts, driving to and fro, watched over loopback on both ends."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.clock = folder, SystemClock()
        self.certificates = folder / "certs"
        make_authority(self.certificates)
        issue(self.certificates, "netem", "lab", hosts=[NETEM_FOR_OPERATOR, NETEM_FOR_ROBOT])
        issue(self.certificates, "robot", ROBOT)
        issue(self.certificates, "observer", "lab", [ROBOT])
        for name in ("alice", "eve"):
            issue(self.certificates, "operator", name, [ROBOT])
        self.scenario_file = folder / "to-and-fro.toml"
        self.scenario_file.write_text(_to_and_fro())
        self.scenario = load_scenario(str(self.scenario_file))
        self.hosts = Hosts()
        self.programs: dict[str, subprocess.Popen[str]] = {}
        for program in ("netem", "robot", "operator"):
            self.start(program)
        self.states = self._observe("robot", 7450)
        self.commands = self._observe("operator", 7451)

    def start(self, program: str) -> None:
        """Start a program, or start it again."""
        own = {"netem": "netem.lab", "robot": f"robot.{ROBOT}", "operator": "operator.alice"}[program]
        words = ["farhand", program, "--tls", str(self.certificates / own)]
        if program == "netem":
            words += ["--network", NETWORK]
            words += ["--listen-operator", "tls/0.0.0.0:7447", "--listen-robot", "tls/0.0.0.0:7448"]
        else:
            words += ["--robot", ROBOT, "--scenario", str(self.scenario_file)]
        if program == "robot":
            words += ["--connect", f"tls/{NETEM_FOR_ROBOT}:7448", "--listen", "tls/127.0.0.1:7450"]
        if program == "operator":
            words += ["--connect", f"tls/{NETEM_FOR_OPERATOR}:7447", "--listen", "tls/127.0.0.1:7451"]
        self.programs[program] = self.hosts.start(program, *words, log=self.folder / f"{program}.log")

    def signal(self, program: str, number: signal.Signals) -> None:
        """Send a signal to a program."""
        self.programs[program].send_signal(number)

    def kill_and_restart(self, program: str) -> None:
        """kill -9, one second of nothing, start."""
        self.programs[program].kill()
        self.programs[program].wait()
        self.pause(1.0)
        self.start(program)

    def attack(self, *words: str) -> None:
        """Run an attacker on the operator's host until it ends."""
        log = self.folder / "attacker.log"
        log.write_text("")
        attacker = self.hosts.start("operator", "farhand.faults.attacker", *words, log=log)
        attacker.wait(60)
        said = log.read_text().split()
        if not said or not said[-1].isdigit() or int(said[-1]) == 0:
            raise FarhandError(
                f"the attack {words[0]} did not take place: {' '.join(said)[-300:] or 'silent'}"
            )

    def second_operator(self) -> None:
        """Another operator with a valid certificate for the same robot, for 5 s."""
        words = ["farhand", "operator", "--tls", str(self.certificates / "operator.eve"), "--robot", ROBOT]
        words += ["--scenario", str(self.scenario_file), "--connect", f"tls/{NETEM_FOR_OPERATOR}:7447"]
        other = self.hosts.start("operator", *words, log=self.folder / "second.log")
        self.pause(8.0)
        other.kill()
        other.wait()

    def replay(self) -> None:
        """Send the first hundred recorded commands again, with a valid certificate."""
        old = [row["bytes"] for _, row in self.commands.rows if row.get("mode") == "run"][:100]
        (self.folder / "recorded").write_text("\n".join(old))
        self.attack("replay", *self._way_in(), str(self.folder / "recorded"))

    def flood(self) -> None:
        """10,000 commands a second with a valid certificate."""
        self.attack("flood", *self._way_in())

    def garbage(self) -> None:
        """A port scan, then random bytes to netem's port."""
        self.attack("garbage", NETEM_FOR_OPERATOR, "7447")

    def slow_reader(self) -> None:
        """A subscriber on the operator's side that stops reading for 5 s."""
        reader = self.hosts.start(
            "operator",
            "farhand.faults.observer",
            f"tls/{NETEM_FOR_OPERATOR}:7447",
            str(self.certificates / "observer.lab"),
            ROBOT,
        )
        self.pause(2.0)
        reader.send_signal(signal.SIGSTOP)
        self.pause(5.0)
        reader.kill()
        reader.wait()

    def unplugged(self, seconds: float) -> None:
        """The cable between operator and netem is out for a time."""
        self.hosts.plug("operator", False)
        self.pause(seconds)
        self.hosts.plug("operator", True)

    def frozen(self, program: str) -> None:
        """SIGSTOP for 5 s."""
        self.signal(program, signal.SIGSTOP)
        self.pause(5.0)
        self.signal(program, signal.SIGCONT)

    def pause(self, seconds: float) -> None:
        """Let real time pass."""
        self.clock.sleep_until(self.clock.now_ns() + to_ns(seconds))

    def wait_driving(self, since_ns: int) -> bool:
        """Wait until the robot has been moving in mode run for half a second; whether that came."""
        end_ns = self.clock.now_ns() + to_ns(PATIENCE)
        while self.clock.now_ns() < end_ns:
            self.pause(0.1)
            recent = self.states.since(max(since_ns, self.clock.now_ns() - to_ns(0.6)))
            if len(recent) >= 15 and all(r["mode"] == "run" and r["speed"] > MOVING for _, r in recent):
                return True
        return False

    def run(self, name: str, fault: Callable[[], None]) -> Outcome:
        """One fault, from steady driving to driving again."""
        self.wait_driving(0)
        begin_ns = self.clock.now_ns()
        fault()
        end_ns = self.clock.now_ns()
        self.wait_driving(end_ns)
        self.pause(AFTER)
        tick = 1.0 / self.scenario.robot.rate_hz
        return judge(name, self.states, self.commands, begin_ns, end_ns, self.scenario.safety.max_age, tick)

    def _way_in(self) -> tuple[str, str, str]:
        return f"tls/{NETEM_FOR_OPERATOR}:7447", str(self.certificates / "operator.eve"), ROBOT

    def _observe(self, host: str, port: int) -> Watcher:
        words = (f"tls/127.0.0.1:{port}", str(self.certificates / "observer.lab"), ROBOT)
        pipe = self.hosts.start(host, "farhand.faults.observer", *words).stdout
        assert pipe is not None
        return Watcher(pipe, self.clock)


def cases(rig: Rig) -> dict[str, Callable[[], None]]:
    """All faults by name."""
    found: dict[str, Callable[[], None]] = {}
    for seconds in (0.5, 2.0, 10.0):
        found[f"link down for {seconds:g} s"] = lambda seconds=seconds: rig.unplugged(seconds)  # type: ignore[misc]
    for program in ("operator", "netem", "robot"):
        found[f"{program} frozen for 5 s"] = lambda program=program: rig.frozen(program)  # type: ignore[misc]
        found[f"{program} killed, restarted"] = lambda program=program: rig.kill_and_restart(program)  # type: ignore[misc]
    found["slow reader beside the operator"] = rig.slow_reader
    found["second operator, valid certificate"] = rig.second_operator
    found["recorded commands replayed"] = rig.replay
    found["flood of 10,000 commands/s"] = rig.flood
    # Last: Zenoh then takes in newcomers slowly for a while, which would hide what an attacker after it does.
    found["port scan and garbage"] = rig.garbage
    return found


def run_faults(only: str = "") -> list[Outcome]:
    """Do the faults whose name holds `only`; returns their outcomes."""
    with tempfile.TemporaryDirectory() as folder:
        rig = Rig(Path(folder))
        try:
            return [rig.run(name, fault) for name, fault in cases(rig).items() if only in name]
        finally:
            rig.hosts.close()


def _to_and_fro() -> str:
    """The point robot's built-in scenario with 250 targets below its obstacles."""
    source = (Path(__file__).parents[2] / "scenarios" / "point-obstacle.toml").read_text()
    targets = [[4.0, 0.0, 0.6], [0.6, 0.0, 0.6]] * 125
    return re.sub(r"(?m)^targets = .*$", f"targets = {targets}", source).replace(
        '"point-obstacle"', '"to-and-fro"', 1
    )


def rows(outcomes: list[Outcome]) -> list[tuple[str, ...]]:
    """The table's cells."""
    return [
        (
            o.name,
            "-" if o.standing is None else f"{o.standing:.2f}",
            "-" if o.again is None else f"{o.again:.2f}",
            f"{o.oldest:.2f}",
            f"{o.sent}",
            f"{o.obeyed}",
            ", ".join(f"{why} {count}" for why, count in o.refused.items()) or "0",
            "yes" if o.safe else "NO",
        )
        for o in outcomes
    ]


HEADINGS = (
    "fault",
    "stands after (s)",
    "drives again (s)",
    "oldest basis (s)",
    "sent",
    "obeyed",
    "refused",
    "safe",
)


def main() -> int:
    """Run, print, and say by the exit code whether all was safe."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="faults whose name holds this")
    parser.add_argument("--markdown", action="store_true", help="print the table for docs/faults.md")
    options = parser.parse_args()
    problem = why_not()
    if problem:
        print(f"faults: {problem}", file=sys.stderr)
        return 2
    outcomes = run_faults(options.only)
    if options.markdown:
        print("| " + " | ".join(HEADINGS) + " |\n|" + "---|" * len(HEADINGS))
        for row in rows(outcomes):
            print("| " + " | ".join(row) + " |")
    else:
        table = Table(*HEADINGS)
        for row in rows(outcomes):
            table.add_row(*row)
        Console(width=150).print(table)
    return 0 if outcomes and all(o.safe for o in outcomes) else 1


if __name__ == "__main__":
    sys.exit(main())
