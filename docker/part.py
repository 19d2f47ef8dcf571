"""One part of the demo in containers: `part.py netem|robot|operator`, settings from the environment.

The three programs meet only through netem. The run's folder, on a volume, is where they leave their results;
two files in it say how far the run is:

    driven   the operator has finished, or somebody's program has died: all end now and write what they have
    ended    the summary is there: the containers may end
"""

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path

DRIVEN, ENDED = "driven", "ended"
LOOK_EVERY = 0.2
"""How often the files are looked for (s)."""
PATIENCE = 8.0
"""How long a program may take to end, and how long to wait for results and for the summary (s)."""
SUMMARY_PATIENCE = 30.0
OPERATOR_PORT, ROBOT_PORT = 7447, 7448


def words(environment: Mapping[str, str], option: str, name: str) -> list[str]:
    """`[option, value]` of a setting, or nothing where it is not set."""
    value = environment.get(name, "").strip()
    return [option, value] if value else []


def common_arguments(environment: Mapping[str, str]) -> list[str]:
    """What operator, robot and summary must be told alike."""
    return words(environment, "--scenario", "SCENARIO")


def choice_arguments(environment: Mapping[str, str]) -> list[str]:
    """What the operator decides and the summary repeats."""
    return [
        *common_arguments(environment),
        *words(environment, "--margin", "MARGIN"),
        *words(environment, "--predictor", "PREDICTOR"),
        *words(environment, "--solver", "SOLVER"),
        *words(environment, "--seed", "SEED"),
    ]


def network_arguments(environment: Mapping[str, str]) -> list[str]:
    """The network SPEC, and where a direction differs."""
    return [
        *words(environment, "--network", "NETWORK"),
        *words(environment, "--uplink", "UPLINK"),
        *words(environment, "--downlink", "DOWNLINK"),
    ]


def program_arguments(role: str, folder: Path, environment: Mapping[str, str]) -> list[str]:
    """The command line of a part's program, after `farhand`."""
    protocol = environment.get("PROTOCOL", "tcp")
    operator_side = f"{protocol}/{environment.get('NETEM_AT_OPERATOR', 'netem-operator')}:{OPERATOR_PORT}"
    robot_side = f"{protocol}/{environment.get('NETEM_AT_ROBOT', 'netem-robot')}:{ROBOT_PORT}"
    security = environment.get("SECURITY", "").split()
    if role == "netem":
        return [
            "netem",
            *("--listen-operator", operator_side, "--listen-robot", robot_side),
            *("--stats", str(folder / "netem.json")),
            *network_arguments(environment),
            *words(environment, "--seed", "SEED"),
            *words(environment, "--backend", "BACKEND"),
            *security,
        ]
    if role == "robot":
        return [
            "robot",
            *("--connect", robot_side, "--result", str(folder / "robot.json")),
            *common_arguments(environment),
            *security,
        ]
    return [
        "operator",
        *("--connect", operator_side, "--result", str(folder / "operator.json")),
        *("--record", str(folder / "run.mcap")),
        *choice_arguments(environment),
        *words(environment, "--time-limit", "TIME_LIMIT"),
        *security,
    ]


class Part:
    """A program, the run's folder, and whether the container was told to end."""

    def __init__(self, role: str, folder: Path, environment: Mapping[str, str]) -> None:
        self.role, self.folder, self.environment = role, folder, environment
        self.told = threading.Event()
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, lambda *_: self.told.set())

    def run(self) -> int:
        """Run the part; returns the container's exit code."""
        if (
            self.role == "netem"
        ):  # the others start when it is healthy, so that nobody sees an earlier run's files
            self.folder.mkdir(parents=True, exist_ok=True)
            for stale in (
                "operator.json",
                "netem.json",
                "robot.json",
                "run.mcap",
                "summary.json",
                DRIVEN,
                ENDED,
            ):
                (self.folder / stale).unlink(missing_ok=True)
        program = self.start(program_arguments(self.role, self.folder, self.environment))
        while program.poll() is None and not self.exists(DRIVEN) and not self.told.wait(LOOK_EVERY):
            pass
        own_end = program.poll() is not None
        code = self.end(program)
        if self.role == "operator":
            why = "" if own_end and code in (0, 1) else self.why(code)
            self.mark(DRIVEN, why)
            return self.summarise(why, code)
        if own_end:
            self.mark(DRIVEN, f"the {self.role} program ended with exit code {code}")
        self.wait_for([ENDED], SUMMARY_PATIENCE)
        return code

    def why(self, code: int) -> str:
        """Why the operator's program did not come to its own end."""
        if self.told.is_set():
            return "interrupted"
        try:
            return (self.folder / DRIVEN).read_text(encoding="utf-8").strip()
        except OSError:
            return f"the operator program ended with exit code {code}"

    def summarise(self, why: str, code: int) -> int:
        """Wait for the others' results and make the summary; returns the demo's exit code."""
        if not self.told.is_set():
            self.wait_for(["netem.json", "robot.json"], PATIENCE)
        arguments = ["summarise", str(self.folder), *choice_arguments(self.environment)]
        arguments += network_arguments(self.environment) + (["--why", why] if why else [])
        found = self.start(arguments).wait()
        self.mark(ENDED, "")
        return found or (1 if why else 0) or code

    def start(self, arguments: Sequence[str]) -> subprocess.Popen[bytes]:
        """Start `farhand ARGUMENTS`; the kernel ends it should this process die."""
        environment = os.environ | {"FARHAND_PARENT": str(os.getpid())}
        return subprocess.Popen([sys.executable, "-m", "farhand", *arguments], env=environment)

    def end(self, program: subprocess.Popen[bytes]) -> int:
        """Ask a program to end, make it if it does not; returns its exit code."""
        if program.poll() is None:
            program.terminate()
            try:
                program.wait(PATIENCE)
            except subprocess.TimeoutExpired:
                program.kill()
        return program.wait()

    def wait_for(self, names: Sequence[str], patience: float) -> None:
        """Wait until files of the run's folder exist, the container is told to end, or patience is over."""
        for _ in range(round(patience / LOOK_EVERY)):
            if all(self.exists(name) for name in names) or self.told.wait(LOOK_EVERY):
                return

    def exists(self, name: str) -> bool:
        """Whether a file of the run's folder exists."""
        return (self.folder / name).exists()

    def mark(self, name: str, text: str) -> None:
        """Write one of the two files, whole or not at all; the first who writes it says why."""
        part = self.folder / f".{name}.{self.role}"
        part.write_text(text + "\n", encoding="utf-8")
        if not self.exists(name):
            part.replace(self.folder / name)
        part.unlink(missing_ok=True)


if __name__ == "__main__":
    results = Path(os.environ.get("RESULTS", "/results")) / os.environ.get("RUN", "demo")
    raise SystemExit(Part(sys.argv[1], results, os.environ).run())
