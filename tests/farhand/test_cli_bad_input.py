"""The command line: help for a stranger, and one line with exit code 2 for whatever cannot work."""

import signal
import socket

import pytest
import typer

from farhand.cli import app, run

NETWORK = ["simulate", "--scenario", "point-obstacle", "--network"]
SET = ["simulate", "--scenario", "point-obstacle", "--set"]


@pytest.fixture(autouse=True)
def keep_signals():
    kept = {s: signal.getsignal(s) for s in (signal.SIGINT, signal.SIGTERM)}
    yield
    for number, handler in kept.items():
        signal.signal(number, handler)


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")
    (tmp_path / "empty.txt").write_text("")
    (tmp_path / "broken.csv").write_text("time_s,delay_ms\n0,10\n1,ten\n")
    (tmp_path / "file").write_text("x")
    (tmp_path / "negative.toml").write_text(
        'name = "x"\nstart = [0, 0, 0]\ntargets = [[1, 0, 0]]\n[robot]\nkind = "point"\nradius = -0.1\n'
    )
    (tmp_path / "inside.toml").write_text(
        'name = "x"\nstart = [0, 0, 0]\ntargets = [[1, 0, 0]]\n'
        '[[obstacles]]\nid = "ball"\nposition = [0.1, 0, 0]\nradius = 0.1\n'
    )
    (tmp_path / "unreachable.toml").write_text('name = "x"\nstart = [5, 0, 0]\ntargets = [[1, 0, 0]]\n')
    (tmp_path / "broken.toml").write_text("name = ")


def all_commands(command, path=()):
    yield path, command
    for name, inner in sorted(getattr(command, "commands", {}).items()):
        yield from all_commands(inner, (*path, name))


COMMANDS = dict(all_commands(typer.main.get_command(app)))


@pytest.mark.parametrize("path", COMMANDS, ids=" ".join)
@pytest.mark.parametrize("flag", ["--help", "-h"])
def test_every_command_has_help(path, flag, capsys):
    assert run([*path, flag]) == 0
    out = capsys.readouterr().out
    assert "Usage:" in out
    assert "--help" in out


@pytest.mark.parametrize("path", COMMANDS, ids=" ".join)
def test_every_command_and_option_says_what_it_is(path):
    command = COMMANDS[path]
    assert command.help
    for parameter in command.params:
        assert parameter.help, f"{' '.join(path)} {parameter.name}"


def test_what_is_built_in_is_listed(capsys):
    assert run(["scenarios"]) == 0
    listed = capsys.readouterr().out
    assert all(name in listed for name in ("ur5-obstacle", "box-obstacle", "point-obstacle"))
    assert run(["networks"]) == 0
    listed = capsys.readouterr().out
    assert all(
        name in listed for name in ("none", "constant:200", "trace:delays.csv", "5g-urban", "lund-stockholm")
    )


def test_no_command_shows_the_help(capsys):
    assert run([]) == 2
    assert "Usage:" in "".join(capsys.readouterr())


BAD = [
    (["nonsense"], "nonsense"),
    (["demo", "--nonsense"], "--nonsense"),
    (["demo", "extra"], "extra"),
    (["demo", "--camera", "pybullet"], "it goes with --steer browser"),
    (["demo", "--steer", "browsr"], "is 'browser' meant? there are tester"),
    (
        ["demo", "--steer", "browser", "--camera", "film"],
        "pybullet, or device:PATH such as device:/dev/video0, or off",
    ),
    (["camera", "--camera", "film"], "pybullet, or device:PATH"),
    (["camera", "--camera", "off"], "pybullet, or device:PATH"),
    (["camera", "--size", "1x1"], "160x120 to 1920x1080"),
    (["camera", "--size", "large"], "WIDTHxHEIGHT"),
    (["camera", "--rate", "nan"], "0.5 to 60 pictures a second"),
    (["camera", "--quality", "96"], "10 to 95"),
    (["camera", "--set", "camera.look_at=[1.25, -0.95, 0.85]"], "look_at: is 0.000 m from eye"),
    (["camera", "--set", "camera.up=[0.0, 0.0, 0.0]"], "up: is zero, or along the line"),
    (["camera", "--set", "camera.field_of_view=3.5"], "camera.field_of_view"),
    (["camera", "--set", "camera.zoom=2"], "unknown field `zoom`; there are"),
    (["demo", "--scenario", "nope"], "nope"),
    (["demo", "--scenario", "nope.toml"], "nope.toml"),
    (["demo", "--scenario", "x" * 300], "no such name"),
    (["demo", "--scenario", "negative.toml"], "robot.radius"),
    (["demo", "--scenario", "inside.toml"], "obstacle 'ball'"),
    (["demo", "--scenario", "unreachable.toml", "--network", "none"], "start"),
    (["simulate", "--scenario", "unreachable.toml", "--network", "none", "--out", "o"], "start"),
    (["demo", "--scenario", "broken.toml"], "not valid TOML"),
    (["demo", "--scenario", "file"], "file"),
    (["demo", "--margin", "huge"], "--margin 'huge'"),
    (["demo", "--predictor", "oracle"], "--predictor 'oracle'"),
    (["demo", "--solver", "magic"], "--solver 'magic'"),
    (["demo", "--seed", "-1"], "--seed"),
    (["demo", "--seed", "x"], "--seed"),
    (["demo", "--time-limit", "0"], "--time-limit"),
    (["demo", "--time-limit", "nan"], "--time-limit"),
    (["demo", "--time-limit", "inf"], "--time-limit"),
    (["simulate", "--computing-time", "nan"], "--computing-time"),
    (["simulate", "--computing-time", "-1"], "--computing-time"),
    ([*NETWORK, "nope"], "nope"),
    ([*NETWORK, ""], "network"),
    ([*NETWORK, "constant:"], "constant"),
    ([*NETWORK, "gaussian:50"], "gaussian"),
    ([*NETWORK, "uniform:50"], "uniform"),
    ([*NETWORK, "uniform:200,50"], "uniform"),
    ([*NETWORK, "constant:-1"], "constant:-1"),
    ([*NETWORK, "constant:nan"], "constant:nan"),
    ([*NETWORK, "constant:inf"], "constant:inf"),
    ([*NETWORK, "constant:10ms20"], "constant"),
    ([*NETWORK, "trace:"], "trace"),
    ([*NETWORK, "trace:nope.csv"], "nope.csv"),
    ([*NETWORK, "trace:empty.txt"], "empty.txt"),
    ([*NETWORK, "trace:broken.csv"], "broken.csv"),
    (["demo", "--uplink", "gaussian:x,y"], "gaussian"),
    (["demo", "--downlink", "constant:-5"], "constant:-5"),
    (["report", "nope"], "nope: no such file"),
    (["report", "."], "holds no run.mcap"),
    (["report", "file"], "not a recording of Farhand"),
    (["report", "empty.txt"], "it is empty"),
    (["report", "a", "b", "c"], "one run or two"),
    (["report", "file", "--out", "nope/x.html"], "--out"),
    (["runs", "nope"], "no such folder"),
    (["runs", ".", "--keep", "2"], "--prune"),
    (["runs", ".", "--prune", "--yes"], "--older-than"),
    (["runs", ".", "--prune", "--keep", "-1"], "--keep"),
    (["demo", "--network", "none", "--out", "file/inside"], "--out"),
    (["simulate", "--network", "none", "--out", "file"], "--out"),
    ([*SET, "controller.gamma"], "KEY=VALUE"),
    ([*SET, "=3"], "KEY=VALUE"),
    ([*SET, "controller.gamma=2"], "controller.gamma"),
    ([*SET, "controller.gamma=nan"], "controller.gamma"),
    ([*SET, "controller.gamma="], "controller.gamma"),
    ([*SET, "controller.colour=1"], "colour"),
    ([*SET, "name.first=1"], "name.first"),
    ([*SET, "controller.gamma=[1"], "controller.gamma"),
    (["robot", "--robot", "a/b"], "a/b"),
    (["robot", "--connect", "nowhere"], "nowhere"),
    (["robot", "--connect", "tcp/h:99999"], "tcp/h:99999"),
    (["robot", "--result", "no/such/folder.json"], "--result"),
    (["operator", "--robot", "*"], "'*'"),
    (["operator", "--report", "tcp/10.0.0.1:7000"], "--report"),
    (["record", "--out", "."], "--out"),
    (["foxglove", "nope"], "nope"),
    (["foxglove", "empty.txt"], "it is empty"),
    (["foxglove", "--listen", "here"], "--listen"),
    (["foxglove", "--connect", "tcp/10.0.0.1:7446"], "--connect"),
    (["foxglove", "--robot", "a/b"], "a/b"),
    (["export", "nope", "--to", "csv", "--out", "o"], "nope"),
    (["export", "empty.txt", "--to", "csv", "--out", "o"], "it is empty"),
    (["export", "empty.txt", "--to", "xls", "--out", "o"], "--to 'xls'"),
    (["export", "empty.txt", "--to", "csv"], "--out"),
    (["operator", "--result", "no/x.json"], "--result"),
    (["operator", "--time-limit", "-3"], "--time-limit"),
    (["operator", "--name", "x" * 65], "1 to 64 printable"),
    (["operator", "--name", "al\nice"], "1 to 64 printable"),
    (["handover", "--connect", "tcp/10.0.0.1:7446"], "--connect"),
    (["handover", "--robot", "a/b"], "a/b"),
    (["handover", "--to", "x" * 65], "--to"),
    (["watch", "--connect", "nowhere"], "nowhere"),
    (["watch", "--robot", ""], "--robot"),
    (["tap", "nowhere"], "nowhere"),
    (["tap"], "endpoint"),
    (["tap", "tcp/127.0.0.1:20001", "--key", "a//b"], "--key 'a//b'"),
    (["tap", "tcp/127.0.0.1:20001", "--count", "0"], "--count"),
    (["netem", "--uplink", "gaussian:5"], "gaussian"),
    (["netem", "--listen-robot", "nowhere"], "nowhere"),
    (["netem", "--robot-network", "arm2"], "arm2"),
    (["netem", "--robot-network", "arm2:up=none"], "NAME:uplink"),
    (["netem", "--robot-network", "arm2=none", "--robot-network", "arm2=loss:1%"], "twice"),
    (["netem", "--robot-network", "arm2=none", "--backend", "tc"], "--robot-network"),
    (["netem", "set", "none", "--robot", "a/b"], "a/b"),
    (["arm", "fit"], "--model or --urdf"),
    (["arm", "fit", "--model", "ur7"], "--model 'ur7': no such arm; nearest are ur5"),
    (["arm", "fit", "--model", "ur5", "--tool-frame", "x"], "--tool-frame"),
    (["arm", "fit", "--model", "ur5", "--out", "no/x.toml"], "--out"),
    (["arm", "fit", "--urdf", "no.urdf"], "URDF no.urdf"),
    (["arm", "fit", "--urdf", "no.urdf", "--srdf", "no.srdf"], "SRDF no.srdf"),
    (["arm", "fit", "--urdf", "no.urdf", "--home", "1,two"], "--home '1,two'"),
    (["demo", "--set", "robot.kind=arm"], "needs model"),
    (["simulate", "--scenario", "panda-obstacle", "--set", "robot.model=pandas"], "nearest are panda"),
    (["simulate", "--scenario", "panda-obstacle", "--set", "robot.joints=[0,0]"], "has 7 joints, not 2"),
    (["certs", "issue", "operator", "al ice", "--robot", "ur5"], "al ice"),
    (["certs", "renew", "../x"], "../x"),
    (["certs", "init", "--dir", "/proc/nothing"], "/proc/nothing"),
    (["certs", "init", "--name", ""], "--name"),
    (["certs", "show", "."], "farhand certs init"),
]


@pytest.mark.parametrize(("arguments", "named"), BAD, ids=[" ".join(a)[:60] or "-" for a, _ in BAD])
def test_bad_input_is_one_line_and_exit_code_2(arguments, named, capsys):
    assert run(arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert captured.err.startswith("farhand")
    assert named.lower() in captured.err.lower()


@pytest.mark.parametrize("program", ["robot", "operator"])
def test_a_port_in_use_is_one_line_and_exit_code_2(program, capfd):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        endpoint = f"tcp/127.0.0.1:{taken.getsockname()[1]}"
        assert run([program, "--scenario", "point-obstacle", "--listen", endpoint]) == 2
        assert run(["netem", "--listen-operator", endpoint, "--listen-robot", "tcp/127.0.0.1:20002"]) == 2
    lines = capfd.readouterr().err.splitlines()
    assert len(lines) == 2
    assert all("already in use" in line and endpoint in line for line in lines)
