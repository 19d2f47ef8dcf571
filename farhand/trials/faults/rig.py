"""The three programs on three hosts, with TLS, driving a robot to and fro, watched on both ends.

The robot is a point, or a UR5 whose emulated controller runs on the robot's host.
"""

import dataclasses
import json
import re
import signal
import subprocess
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from farhand.common.errors import FarhandError
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.programs.command_line import NetemWords, OperatorWords, RobotWords, Words
from farhand.runs.scenario import load_scenario
from farhand.site.certificates import issue, make_authority
from farhand.trials.faults.controller import RATE_HZ, Controller
from farhand.trials.faults.judgement import MOVING, Outcome, Seen, judge
from farhand.trials.faults.observer import LISTEN
from farhand.trials.faults.watching import Watcher
from farhand.trials.hosts import NETEM_FOR_OPERATOR, NETEM_FOR_ROBOT, Hosts

ROBOT = "point"
PATIENCE = 30.0
FIRST_PATIENCE = 300.0
"""Until it drives for the first time: on a new machine robot and solver are compiled before (s)."""
AFTER = 1.0
LAST = 8
"""Lines of each program that are shown where none drives."""
NETWORK = "constant:20"
LAWFUL = "operator.alice"
PROGRAMS = ("netem", "robot", "operator")
STATES_SEEN, COMMANDS_SEEN = "tls/127.0.0.1:7453", "tls/127.0.0.1:7454"
"""Where the observers listen: they outlive robot and operator, whose every message they hear."""


class Rig:
    """Starts everything; `hosts.close` ends it.

    Args:
        folder: for certificates, logs, and what attackers have.
        attack_time: how long an attack goes on (s).
        kind: of the robot, `point` or `ur`.
    """

    def __init__(self, folder: Path, attack_time: float = 5.0, kind: str = "point") -> None:
        self.folder, self.attack_time, self.clock = folder, attack_time, SystemClock()
        self._patience = FIRST_PATIENCE
        self.certificates = folder / "certs"
        _issue_all(self.certificates, folder / "foreign")
        self.scenario_file = folder / "to-and-fro.toml"
        self.scenario_file.write_text(_arm_to_and_fro() if kind == "ur" else _to_and_fro())
        self.scenario = load_scenario(str(self.scenario_file))
        self.hosts = Hosts()
        self.programs: dict[str, subprocess.Popen[str]] = {}
        self._controller: Controller | None = None
        self.states = self.observe("robot", f"{LISTEN}{STATES_SEEN}")
        self.commands = self.observe("operator", f"{LISTEN}{COMMANDS_SEEN}")
        if kind == "ur":
            self._controller = Controller(self.hosts, self.folder / "controller.log", self.scenario_file)
        for program in PROGRAMS:
            self.start(program)
        self.reports = self.observe("operator", "tcp/127.0.0.1:7446")

    @property
    def has_controller(self) -> bool:
        """Whether the robot is an arm behind a controller of its own, which knows when it stands."""
        return self._controller is not None

    def start(self, program: str, environment: Mapping[str, str] | None = None) -> None:
        """Start a program, or start it again."""
        own = {"netem": "netem.lab", "robot": f"robot.{ROBOT}", "operator": LAWFUL}[program]
        words = self._words(program, str(self.certificates / own)).words()
        self.programs[program] = self.hosts.start(
            program, "farhand", *words, log=self.log(program), environment=environment
        )

    def _words(self, program: str, tls: str) -> Words:
        scenario = str(self.scenario_file)
        if program == "netem":
            return NetemWords(
                tls=tls,
                network=NETWORK,
                control="7449",
                metrics=7452,
                listen_operator="tls/0.0.0.0:7447",
                listen_robot="tls/0.0.0.0:7448",
            )
        if program == "robot":
            near, listen = (f"tls/{NETEM_FOR_ROBOT}:7448", STATES_SEEN), ("tls/127.0.0.1:7450",)
            return RobotWords(tls=tls, robot=ROBOT, scenario=scenario, connect=near, listen=listen)
        return OperatorWords(
            tls=tls,
            robot=ROBOT,
            scenario=scenario,
            connect=(f"tls/{NETEM_FOR_OPERATOR}:7447", COMMANDS_SEEN),
            listen=("tls/127.0.0.1:7451",),
            report="tcp/127.0.0.1:7446",
        )

    def log(self, program: str) -> Path:
        """Where a program's lines go."""
        return self.folder / f"{program}.log"

    def said(self, since: Mapping[str, int]) -> dict[str, list[str]]:
        """The lines of each program's log after the given lengths (see `said_so_far`)."""
        return {
            name: self.log(name).read_text(errors="replace")[at:].splitlines() for name, at in since.items()
        }

    def said_so_far(self) -> dict[str, int]:
        """Length of each program's log, in characters."""
        return {name: len(self.log(name).read_text(errors="replace")) for name in PROGRAMS}

    def end_and_restart(
        self,
        program: str,
        number: signal.Signals,
        pause: float = 1.0,
        environment: Mapping[str, str] | None = None,
    ) -> None:
        """End a program by a signal, let `pause` s pass, start it again."""
        self.programs[program].send_signal(number)
        self.programs[program].wait(20)
        self.pause(pause)
        self.start(program, environment)

    def frozen(self, program: str) -> None:
        """SIGSTOP for 5 s."""
        self.programs[program].send_signal(signal.SIGSTOP)
        self.pause(5.0)
        self.programs[program].send_signal(signal.SIGCONT)

    def unplugged(self, host: str, seconds: float) -> None:
        """The cable between a host and netem's is out for a time."""
        self.hosts.plug(host, False)
        self.pause(seconds)
        self.hosts.plug(host, True)

    def attack(self, host: str, *words: str) -> dict[str, Any]:
        """Run an attacker on a host until it ends; what it says of itself."""
        return self.result(self.start_attack(host, *words), words[0])

    def start_attack(self, host: str, *words: str) -> subprocess.Popen[str]:
        """An attacker that runs on a host."""
        return self.hosts.start(
            host, "farhand.trials.faults.attacker", *words, "--seconds", str(self.attack_time)
        )

    def result(self, attacker: subprocess.Popen[str], what: str) -> dict[str, Any]:
        """What an attacker says of itself at its end; raises FarhandError if nothing."""
        out, _ = attacker.communicate(timeout=90)
        try:
            found = json.loads(out.splitlines()[-1])
        except (IndexError, ValueError):
            raise FarhandError(f"the attack {what} did not take place: {out[-300:] or 'silent'}") from None
        if not isinstance(found, dict) or not found.get("sent"):
            raise FarhandError(f"the attack {what} sent nothing: {found}")
        return found

    def observe(self, host: str, endpoint: str, pace: str = "") -> Watcher:
        """Watch what comes from an endpoint, on a host."""
        pipe = self.start_observer(host, endpoint, pace).stdout
        assert pipe is not None
        return Watcher(pipe, self.clock)

    def start_observer(self, host: str, endpoint: str, pace: str = "") -> subprocess.Popen[str]:
        """An observer that runs on a host."""
        tls = str(self.certificates / "observer.lab") if "tls/" in endpoint else ""
        return self.hosts.start(host, "farhand.trials.faults.observer", endpoint, tls, ROBOT, pace)

    def pause(self, seconds: float) -> None:
        """Let real time pass."""
        self.clock.sleep_until(self.clock.now_ns() + to_ns(seconds))

    def wait_driving(self, since_ns: int) -> bool:
        """Wait until the robot has been moving in mode run for half a second; whether that came."""
        patience, self._patience = self._patience, PATIENCE
        end_ns = self.clock.now_ns() + to_ns(patience)
        while self.clock.now_ns() < end_ns:
            self.pause(0.1)
            recent = self.states.since(max(since_ns, self.clock.now_ns() - to_ns(0.6)))
            if len(recent) >= 15 and all(r["mode"] == "run" and r["speed"] > MOVING for _, r in recent):
                return True
        return False

    def measure(self, fault: Callable[[], Any]) -> tuple[Outcome, Any]:
        """One fault, from steady driving to driving again: what came of it, and what `fault` returns."""
        if not self.wait_driving(self.clock.now_ns()):
            last = {name: lines[-LAST:] for name, lines in self.said(dict.fromkeys(PROGRAMS, 0)).items()}
            raise FarhandError(f"the robot does not drive; the last that was said: {last}")
        if self._controller is not None:
            self._controller.mark()
        begin_ns = self.clock.now_ns()
        found = fault()
        end_ns = self.clock.now_ns()
        self.wait_driving(end_ns)
        self.pause(AFTER)
        known = {tuple(r["command"]): r for _, r in self.commands.rows if "command" in r}
        seen = Seen(
            self.states.since(begin_ns), self.commands.since(begin_ns), self.reports.since(begin_ns), known
        )
        tick = 1.0 / self.scenario.robot.rate_hz
        outcome = judge(seen, begin_ns, end_ns, self.scenario.safety.max_age, tick)
        if self._controller is not None:
            outcome = dataclasses.replace(outcome, arm_stood=self._controller.stood())
        return outcome, found


def _issue_all(folder: Path, foreign: Path) -> None:
    """Certificates of everybody lawful, and of the attackers who have one."""
    make_authority(folder)
    issue(folder, "netem", "lab", hosts=[NETEM_FOR_OPERATOR, NETEM_FOR_ROBOT])
    issue(folder, "robot", ROBOT)
    issue(folder, "robot", "box")
    issue(folder, "observer", "lab", [ROBOT])
    for name in ("alice", "eve"):
        issue(folder, "operator", name, [ROBOT])
    issue(folder, "operator", "bob", ["box"])
    issue(folder, "operator", "ended", [ROBOT], days=-1.0)
    issue(folder, "operator", "mallory", [ROBOT])
    for known in folder.glob("*/members/operator.mallory.pem"):
        known.unlink()  # of the right authority, but nobody has been told of it
    make_authority(foreign)
    issue(foreign, "operator", "alice", [ROBOT])


def _to_and_fro() -> str:
    """The point robot's built-in scenario with 250 targets below its obstacles."""
    return _with_targets("point-obstacle", [[4.0, 0.0, 0.6], [0.6, 0.0, 0.6]])


def _arm_to_and_fro() -> str:
    """The UR5's built-in scenario with 250 targets over its obstacle, for an arm behind a controller on its host."""
    source = _with_targets("ur5-obstacle", [[0.45, 0.35, 0.48], [0.45, -0.35, 0.48]])
    return source.replace(
        'kind = "ur5"', f'kind = "ur"\nmodel = "ur5"\nhost = "127.0.0.1"\nrate_hz = {RATE_HZ:g}', 1
    )


def _with_targets(name: str, ends: list[list[float]]) -> str:
    source = (Path(__file__).parents[2] / "scenarios" / f"{name}.toml").read_text()
    return re.sub(r"(?m)^targets = .*$", f"targets = {ends * 125}", source).replace(
        f'"{name}"', '"to-and-fro"', 1
    )
