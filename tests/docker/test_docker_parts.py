import importlib.util
import os
import signal
import stat
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from farhand.cli import run

ROOT = Path(__file__).resolve().parents[2]
DOCKER = ROOT / "docker"


def load(name: str):
    spec = importlib.util.spec_from_file_location(f"docker_{name}", DOCKER / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


part = load("part")

ENVIRONMENT = {"NETWORK": "gaussian:50,20 loss:1%", "SEED": "3", "MARGIN": "", "SCENARIO": "ur5-obstacle"}


def option(arguments: list[str], name: str) -> str:
    return arguments[arguments.index(name) + 1]


def test_each_part_meets_netem_on_its_own_side(tmp_path):
    netem, robot, operator = (
        part.program_arguments(role, tmp_path, ENVIRONMENT) for role in ("netem", "robot", "operator")
    )
    assert option(netem, "--listen-operator") == option(operator, "--connect") == "tcp/netem-operator:7447"
    assert option(netem, "--listen-robot") == option(robot, "--connect") == "tcp/netem-robot:7448"
    assert option(netem, "--uplink") == option(netem, "--downlink") == "gaussian:50,20 loss:1%"
    assert option(operator, "--seed") == option(netem, "--seed") == "3"
    assert "--margin" not in operator
    assert option(robot, "--scenario") == option(operator, "--scenario")


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        ({}, ("constant:7", "5g-urban")),
        ({"NETWORK": "none"}, ("none", "none")),
        ({"DOWNLINK": "loss:1%"}, ("constant:7", "loss:1%")),
        ({"NETWORK": "none", "UPLINK": "loss:1%"}, ("loss:1%", "none")),
        ({"SCENARIO": "ur5-obstacle"}, ("5g-urban", "5g-urban")),
        ({"SCENARIO": "/nowhere.toml"}, ("5g-urban", "5g-urban")),  # the programs say so
    ],
)
def test_the_scenarios_network_is_emulated_and_summarised_unless_another_is_set(said, expected, tmp_path):
    scenario = tmp_path / "own.toml"
    scenario.write_text(
        'name = "own"\nstart = [0, 0, 0.5]\ntargets = [[1, 0, 0.5]]\n[network]\nuplink = "constant:7"\n'
    )
    environment = {"SCENARIO": str(scenario), "NETWORK": "", "UPLINK": ""} | said
    for words in (
        part.program_arguments("netem", tmp_path, environment),
        part.summarise_arguments(tmp_path, environment, ""),
    ):
        assert (option(words, "--uplink"), option(words, "--downlink")) == expected


@pytest.mark.parametrize("role", ["netem", "robot", "operator"])
def test_every_option_exists(role, tmp_path):
    settings = ENVIRONMENT | {"MARGIN": "paper", "PREDICTOR": "echo", "SOLVER": "sqp", "TIME_LIMIT": "5"}
    settings |= {"UPLINK": "none", "DOWNLINK": "none", "BACKEND": "tc", "TLS": str(tmp_path)}
    for arguments in (
        part.program_arguments(role, tmp_path, settings),
        part.summarise_arguments(tmp_path, settings, "x"),
    ):
        assert run([*arguments, "--help"]) == 0, arguments
    assert run([*arguments, "--no-such-option", "--help"]) == 2


def test_tls_where_the_container_has_certificates(tmp_path):
    settings = ENVIRONMENT | {"TLS": str(tmp_path)}
    for role in part.ROLES:
        assert "--insecure" in part.program_arguments(role, tmp_path, settings)
    (tmp_path / "cert.pem").touch()
    for role in part.ROLES:
        arguments = part.program_arguments(role, tmp_path, settings)
        assert "--insecure" not in arguments
        assert option(arguments, "--tls") == str(tmp_path)
        assert not any("tcp/" in each for each in arguments if each != part.REPORT)


class FakePart(part.Part):
    """A part whose programs are one-line scripts."""

    def __init__(self, role, folder, scripts):
        self.role, self.folder, self.environment = role, folder, {}
        self.told = threading.Event()
        self.scripts = scripts
        self.started: list[list[str]] = []

    def start(self, arguments):
        self.started.append(list(arguments))
        return subprocess.Popen([sys.executable, "-c", self.scripts.get(arguments[0], OBEYS)])


FOREVER = "import signal; signal.alarm(5); signal.pause()"  # long enough to be told
OBEYS = "import signal, sys; signal.signal(15, lambda *_: sys.exit(0)); signal.pause()"


@pytest.fixture(autouse=True)
def quick(monkeypatch, tmp_path):
    monkeypatch.setattr(part, "LOOK_EVERY", 0.02)
    monkeypatch.setattr(part, "PATIENCE", 0.4)
    monkeypatch.setattr(part, "SUMMARY_PATIENCE", 0.4)
    monkeypatch.setattr(part, "FAREWELL", 0.4)
    monkeypatch.setattr(part, "FAILED", tmp_path / "failed")


def test_the_operators_end_ends_all_and_the_summary_gives_the_code(tmp_path):
    for name in ("netem.json", "robot.json"):
        (tmp_path / name).write_text("{}")
    operator = FakePart("operator", tmp_path, {"operator": "", "summarise": "raise SystemExit(0)"})
    assert operator.run() == 0
    assert (tmp_path / "driven").read_text().strip() == ""
    assert (tmp_path / "ended").exists()
    assert "--why" not in operator.started[-1]
    unsafe = FakePart("operator", tmp_path, {"operator": "", "summarise": "raise SystemExit(1)"})
    (tmp_path / "driven").unlink()
    assert unsafe.run() == 1


def test_an_operator_that_did_not_finish_is_no_success(tmp_path):
    operator = FakePart("operator", tmp_path, {"operator": "raise SystemExit(1)", "summarise": ""})
    assert operator.run() == 1


def test_bad_input_of_the_operator_is_told_and_ends_all(tmp_path):
    operator = FakePart(
        "operator", tmp_path, {"operator": "raise SystemExit(2)", "summarise": "raise SystemExit(1)"}
    )
    assert operator.run() != 0
    assert operator.started[-1][-2:] == ["--why", "the operator program ended with exit code 2"]
    assert (tmp_path / "driven").exists()


@pytest.mark.parametrize("role", ["netem", "robot"])
def test_the_others_end_when_the_operator_has_driven(role, tmp_path, monkeypatch):
    monkeypatch.setattr(part, "PATIENCE", 20.0)  # a busy host takes its time to end a program that obeys
    waiting = FakePart(role, tmp_path, {role: OBEYS})
    timer = threading.Timer(0.3, (tmp_path / "driven").write_text, ["\n"])
    timer.start()
    assert waiting.run() in (0, -signal.SIGTERM)
    timer.join()


def test_a_dead_robot_ends_the_operator_and_says_why(tmp_path):
    robot = FakePart("robot", tmp_path, {"robot": "raise SystemExit(7)"})
    operator = FakePart("operator", tmp_path, {"operator": FOREVER, "summarise": ""})
    timer = threading.Timer(0.3, robot.run)
    timer.start()
    assert operator.run() != 0
    timer.join()
    assert operator.started[-1][-2:] == ["--why", "the robot program ended with exit code 7"]


def test_a_part_that_failed_first_keeps_nobody_waiting(tmp_path):
    netem = FakePart("netem", tmp_path, {"netem": "raise SystemExit(2)"})
    assert netem.run() == 2
    assert part.FAILED.exists()
    part.FAILED.unlink()
    for role in ("robot", "operator"):
        late = FakePart(role, tmp_path, {})
        assert late.run() == 1
        assert late.started == []
        assert part.FAILED.exists()
    assert (tmp_path / "ended").exists()


def test_a_silent_container_ends_the_run_and_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr(part, "SILENCE", 0.1)
    (tmp_path / "alive.robot").touch()  # and never again
    (tmp_path / "netem.json").write_text("{}")
    operator = FakePart("operator", tmp_path, {"operator": FOREVER, "summarise": ""})
    assert operator.run() == 1
    assert operator.started[-1][-2:] == ["--why", "the robot's container has died"]
    assert not (tmp_path / "alive.operator").exists()


def test_without_an_operator_the_others_end_at_once(tmp_path, monkeypatch):
    monkeypatch.setattr(part, "SILENCE", 0.1)
    monkeypatch.setattr(part, "SUMMARY_PATIENCE", 2.0)
    (tmp_path / "alive.operator").touch()
    netem = FakePart("netem", tmp_path, {"netem": OBEYS})
    netem.clear = lambda: None
    netem.run()
    assert (tmp_path / "ended").exists()


def test_a_part_that_lives_is_not_silent(tmp_path, monkeypatch):
    monkeypatch.setattr(part, "SILENCE", 0.1)
    here, there = part.Peers("netem", tmp_path), part.Peers("robot", tmp_path)
    for count in range(50):
        assert here.look() == there.look() == ""
        os.utime(
            tmp_path / "alive.netem", ns=(count, count)
        )  # whatever the resolution of the file system's times
    there.leave()
    assert [here.look() for _ in range(50)] == [""] * 50
    assert here.gone()
    assert not there.gone()


def test_a_part_that_is_told_to_end_tells_the_others(tmp_path):
    robot = FakePart("robot", tmp_path, {"robot": OBEYS})
    robot.told.set()
    robot.run()
    assert (tmp_path / "driven").read_text().strip() == "the robot's container was told to end"


def test_a_program_that_does_not_obey_is_killed(tmp_path):
    deaf = "import signal; signal.signal(15, signal.SIG_IGN); open({!r}, 'w').close(); signal.pause()"
    ready = tmp_path / "ready"
    waiting = FakePart("robot", tmp_path, {"robot": deaf.format(str(ready))})
    program = waiting.start(["robot"])
    while not ready.exists():
        assert program.poll() is None
    assert waiting.end(program) == -signal.SIGKILL


def test_netem_clears_what_an_earlier_run_left(tmp_path):
    folder = tmp_path / "run"
    folder.mkdir()
    for name in ("driven", "ended", "robot.json", "summary.json"):
        (folder / name).write_text("old")
    netem = FakePart("netem", folder, {"netem": ""})
    netem.run()
    assert not (folder / "robot.json").exists()
    assert (folder / "driven").read_text().strip() == "the netem program ended with exit code 0"


@pytest.mark.parametrize("name", ["entry.sh", "healthy.sh", "keys.sh", "try.sh", "systemd/try.sh"])
def test_scripts_are_well_formed(name):
    subprocess.run(["sh", "-n", str(DOCKER / name)], check=True)


def test_health_is_what_the_kernel_says():
    import socket

    with socket.socket() as server, socket.socket() as client:
        server.bind(("127.0.0.1", 0))
        port = str(server.getsockname()[1])
        healthy = ["sh", str(DOCKER / "healthy.sh")]
        assert subprocess.run([*healthy, "listening", port], capture_output=True, check=False).returncode == 1
        server.listen()
        assert subprocess.run([*healthy, "listening", port], capture_output=True, check=False).returncode == 0
        assert subprocess.run([*healthy, "connected", port], capture_output=True, check=False).returncode == 1
        client.connect(("127.0.0.1", int(port)))
        assert subprocess.run([*healthy, "connected", port], capture_output=True, check=False).returncode == 0


def test_no_service_has_more_rights_than_it_says():
    text = (DOCKER / "compose.yaml").read_text()
    for line in ("read_only: true", "cap_drop: [ALL]", "no-new-privileges:true", "internal: true"):
        assert line in text
    assert "cap_add" not in text
    assert "privileged: true" not in text
    assert "condition: service_completed_successfully }" in text.split("\n  verdict:\n")[1].split("\n\n")[0]
    operator, robot = (text.split(f"\n  {name}:\n")[1].split("\n\n")[0] for name in ("operator", "robot"))
    assert "networks: [operator_side]" in operator
    assert "networks: [robot_side]" in robot
    assert stat.S_IMODE(os.stat(DOCKER / "compose.yaml").st_mode) & 0o044
