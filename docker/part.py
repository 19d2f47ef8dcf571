"""One part of the demo in containers: `part.py netem|robot|operator`, settings from the environment.

The three programs meet only through netem. The run's folder, on a volume, is where they leave their results;
these files in it say how far the run is:

    driven       the operator has finished, or a program or container has died: all end and write what they have
    ended        the summary is there: the containers may end
    alive.ROLE   touched while a part lives, gone when it has ended: each ends whatever became of the others
"""

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

from farhand.common.errors import InputError
from farhand.netem.settings import NetworkSettings
from farhand.programs.command_line import (
    DEFAULT_NETWORK,
    DEFAULT_SCENARIO,
    NetemWords,
    OperatorWords,
    RecordWords,
    RobotWords,
    Secured,
    SummariseWords,
)
from farhand.runs.files import NETEM, OPERATOR, RECORDING, ROBOT
from farhand.runs.scenario import load_scenario

ROLES = ("netem", "robot", "operator")
DRIVEN, ENDED = "driven", "ended"
RESULTS = (OPERATOR, NETEM, ROBOT, RECORDING, "run.png", "run.pdf", "summary.json")
LOOK_EVERY = 0.2
"""How often the files are looked for (s)."""
PATIENCE = 8.0
"""How long a program may take to end, and how long to wait for results and for the summary (s)."""
SUMMARY_PATIENCE = 30.0
SILENCE = 5.0
"""How long a part that lived may give no sign before it counts as dead (s)."""
FAREWELL = 3.0
"""How long the operator's container waits for the others to be gone (s)."""
DIED = "the {}'s container has died"
FAILED = Path("/tmp/failed")
"""Tells healthy.sh of this container that the program has ended by itself: nobody need wait for its health."""
OPERATOR_PORT, ROBOT_PORT = 7447, 7448
REPORT = "tcp/127.0.0.1:7446"
"""Inside the operator's container, where its recorder comes for what happened."""


def setting(environment: Mapping[str, str], name: str) -> str:
    """A setting; empty where it is not set."""
    return environment.get(name, "").strip()


def choice(environment: Mapping[str, str]) -> dict[str, str]:
    """What the operator decides and the summary repeats, by field."""
    names = ("scenario", "margin", "predictor", "solver", "seed")
    return {name: setting(environment, name.upper()) for name in names}


def network(environment: Mapping[str, str]) -> dict[str, str]:
    """The SPECs of both directions, by field: what is set goes before the scenario's, and that before a default."""
    try:
        own = load_scenario(setting(environment, "SCENARIO") or DEFAULT_SCENARIO).network
    except InputError:  # robot and operator read it as well, and say what is wrong
        own = NetworkSettings()
    both = setting(environment, "NETWORK")
    return {
        "uplink": setting(environment, "UPLINK") or both or own.uplink or DEFAULT_NETWORK,
        "downlink": setting(environment, "DOWNLINK") or both or own.downlink or DEFAULT_NETWORK,
    }


def certificates(environment: Mapping[str, str]) -> str:
    """The folder of the certificates that the container has been given; empty where it has none."""
    folder = environment.get("TLS", "/tls")
    return folder if os.path.exists(f"{folder}/cert.pem") else ""


def program_arguments(role: str, folder: Path, environment: Mapping[str, str]) -> list[str]:
    """The command line of a part's program, after `farhand`."""
    folder_of_certificates = certificates(environment)
    protocol = "tls" if folder_of_certificates else "tcp"
    operator_side = f"{protocol}/{environment.get('NETEM_AT_OPERATOR', 'netem-operator')}:{OPERATOR_PORT}"
    robot_side = f"{protocol}/{environment.get('NETEM_AT_ROBOT', 'netem-robot')}:{ROBOT_PORT}"
    secured = Secured(tls=folder_of_certificates, insecure=not folder_of_certificates)
    if role == "netem":
        return NetemWords(
            **asdict(secured),
            **network(environment),
            listen_operator=operator_side,
            listen_robot=robot_side,
            seed=setting(environment, "SEED"),
            stats=str(folder / NETEM),
            backend=setting(environment, "BACKEND"),
        ).words()
    if role == "robot":
        return RobotWords(
            **asdict(secured),
            scenario=setting(environment, "SCENARIO"),
            connect=(robot_side,),
            result=str(folder / ROBOT),
        ).words()
    return OperatorWords(
        **asdict(secured),
        **choice(environment),
        connect=(operator_side,),
        time_limit=setting(environment, "TIME_LIMIT"),
        report=REPORT,
        result=str(folder / OPERATOR),
    ).words()


def record_arguments(folder: Path) -> list[str]:
    """The command line of the recorder beside the operator's program, after `farhand`."""
    return RecordWords(connect=REPORT, out=str(folder / RECORDING)).words()


def summarise_arguments(folder: Path, environment: Mapping[str, str], why: str) -> list[str]:
    """The command line that makes the summary, after `farhand`."""
    return SummariseWords(folder=str(folder), **choice(environment), **network(environment), why=why).words()


class Peers:
    """The signs of life of the other parts, counted in looks, since no two clocks need to agree."""

    def __init__(self, role: str, folder: Path) -> None:
        self._own = folder / f"alive.{role}"
        self._others = {other: folder / f"alive.{other}" for other in ROLES if other != role}
        self._seen: dict[str, tuple[int, int]] = {}

    def look(self) -> str:
        """Give a sign oneself; returns the role of a part that has fallen silent, or nothing."""
        self._own.touch()
        for role, path in self._others.items():
            try:
                stamp = path.stat().st_mtime_ns
            except OSError:  # it has not started yet, or has ended in order
                continue
            last, looks = self._seen.get(role, (stamp, 0))
            looks = looks + 1 if stamp == last else 0
            self._seen[role] = stamp, looks
            if looks * LOOK_EVERY > SILENCE:
                return role
        return ""

    def leave(self) -> None:
        """Say that one ends in order."""
        self._own.unlink(missing_ok=True)

    def gone(self) -> bool:
        """Whether all others have ended in order."""
        return not any(path.exists() for path in self._others.values())


class Part:
    """A program, the run's folder, and whether the container was told to end."""

    def __init__(self, role: str, folder: Path, environment: Mapping[str, str]) -> None:
        self.role, self.folder, self.environment = role, folder, environment
        self.told = threading.Event()
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, lambda *_: self.told.set())

    def run(self) -> int:
        """Run the part; returns the container's exit code."""
        if self.role == "netem":  # the others start after it, and see no earlier run's files
            self.clear()
        peers = Peers(self.role, self.folder)
        try:
            code = self.drive(peers)
        finally:
            peers.leave()
        if self.role == "operator":
            self.wait_until(peers.gone, FAREWELL)
        return code

    def clear(self) -> None:
        """Make the run's folder, or remove from it what an earlier run left."""
        if not self.folder.exists():
            self.folder.mkdir(parents=True)
            self.folder.chmod(0o2775)  # netem may be root, of the others' group
        for stale in (DRIVEN, ENDED, *RESULTS, *(f"alive.{role}" for role in ROLES)):
            (self.folder / stale).unlink(missing_ok=True)

    def drive(self, peers: Peers) -> int:
        """Run the program to the end of the drive, then see to the results; returns the container's exit code."""
        if self.exists(DRIVEN):
            print(f"{self.role}: not started: {self.why(0)}", file=sys.stderr, flush=True)
            FAILED.touch()
            if self.role == "operator":
                self.mark(ENDED, "")
            self.wait_until(lambda: self.exists(ENDED), SUMMARY_PATIENCE)
            return 1
        program = self.start(program_arguments(self.role, self.folder, self.environment))
        recorder = self.start(record_arguments(self.folder)) if self.role == "operator" else None
        silent = ""
        while program.poll() is None and not self.exists(DRIVEN) and not self.told.wait(LOOK_EVERY):
            if silent := peers.look():
                self.mark(DRIVEN, DIED.format(silent))
        own_end = program.poll() is not None
        code = self.end(program)
        if recorder is not None:
            self.end(recorder)
        if self.role == "operator":
            why = "" if own_end and code in (0, 1) else self.why(code)
            self.mark(DRIVEN, why)
            return self.summarise(why, code)
        if own_end:
            FAILED.touch()
            self.mark(DRIVEN, f"the {self.role} program ended with exit code {code}")
        elif self.told.is_set():
            self.mark(DRIVEN, f"the {self.role}'s container was told to end")
        if silent == "operator":
            self.mark(ENDED, "")  # nobody will make a summary
        self.wait_until(lambda: self.exists(ENDED), SUMMARY_PATIENCE)
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
        results = [f"{role}.json" for role in ("netem", "robot") if why != DIED.format(role)]
        self.wait_until(lambda: all(self.exists(name) for name in results), PATIENCE)
        found = self.start(summarise_arguments(self.folder, self.environment, why)).wait()
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

    def wait_until(self, done: Callable[[], bool], patience: float) -> None:
        """Wait until something is so, the container is told to end, or patience is over."""
        for _ in range(round(patience / LOOK_EVERY)):
            if done() or self.told.wait(LOOK_EVERY):
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
