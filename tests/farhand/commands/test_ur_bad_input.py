"""What cannot work with a UR arm: one line, and nothing moves."""

import pytest

from farhand.cli import run
from farhand.robot_side.arm import catalogue
from farhand.robot_side.arm.model import model

OTHERWISE = 'name = "x"\nstart = [0.45, -0.35, 0.3]\ntargets = [[0.45, 0.35, 0.3]]\n[robot]\n'


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def refused(capsys, *words):
    code = run(list(words))
    said = capsys.readouterr()
    lines = (said.out + said.err).strip().splitlines()
    assert code == 2, said
    assert len(lines) == 1, lines
    return lines[0]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("ur", "emulator", "--model", "ur6"), "cannot be emulated; is ur"),
        (("ur", "emulator", "--model", "ur16e"), "its shape is not known here: give its urdf"),
        (
            ("ur", "check", "--host", "127.0.0.1", "--model", "ur10e"),
            "its shape is not known here: give its urdf",
        ),
        (("ur", "emulator", "--address", "10.0.0.1"), "listens on loopback only"),
        (("ur", "emulator", "--address", "here"), "listens on loopback only"),
        (("ur", "emulator", "--joints", "0,0"), "6 joints, not 2"),
        (("ur", "emulator", "--joints", "a,b"), "expected numbers"),
        (("ur", "emulator", "--scenario", "panda-obstacle"), "no UR arm"),
        (("ur", "emulator", "--scenario", "ur5-obstacle", "--model", "ur10"), "arm is a ur5"),
        (("ur", "emulator", "--then", "explode"), "no such command"),
        (("ur", "emulator", "--then", "after x cut"), "expected seconds and a command"),
        (("ur", "check", "--host", ""), "--host: is empty"),
        (("ur", "check", "--host", "127.0.0.1", "--model", "panda"), "is no UR arm"),
        (("ur", "recover", "--host", ""), "--host: is empty"),
        (("ur", "recover", "--host", "no.such.host.invalid"), "no address is known by that name"),
        (("robot", "--host", "127.0.0.1", "--scenario", "panda-obstacle"), "has no UR arm"),
        (("robot", "--host", ""), "--host: is empty"),
        (
            ("robot", "--host", "127.0.0.1", "--set", "robot.model=ur10e"),
            "model 'ur10e': its shape is not known here",
        ),
        (
            (
                "simulate",
                "--scenario",
                "ur5-obstacle",
                "--set",
                "robot.kind=ur",
                "--set",
                "robot.model=ur5",
                "--set",
                "robot.host=127.0.0.1",
            ),
            "virtual time cannot drive a real robot",
        ),
        (("trial", "ur", "--address", "10.0.0.1"), "loopback only"),
    ],
)
def test_one_line_says_what_would_be_right(words, said, capsys):
    assert said in refused(capsys, *words)


@pytest.mark.parametrize(
    ("robot", "said"),
    [
        ('kind = "ur"\nmodel = "ur5"\n', "needs host"),
        ('kind = "ur"\nhost = "10.0.0.2"\n', "needs model"),
        ('kind = "ur"\nhost = "10.0.0.2"\nmodel = "panda"\n', "no UR arm"),
        ('kind = "ur"\nhost = "10.0.0.2"\nmodel = "ur7"\n', "no such arm"),
        ('kind = "ur"\nhost = "10.0.0.2"\nmodel = "ur10e"\n', "its shape is not known here"),
        ('kind = "ur"\nhost = "10.0.0.2"\nmodel = "ur5"\n[robot.ur]\npayload = -1\n', "robot.ur.payload"),
        (
            'kind = "ur"\nhost = "10.0.0.2"\nmodel = "ur5"\n[robot.ur]\ndeadline = "never"\n',
            "robot.ur.deadline",
        ),
        (
            'kind = "ur"\nhost = "10.0.0.2"\nmodel = "ur5"\n[robot.ur]\ndeadline_time = 1.0\n',
            "robot.ur.deadline_time",
        ),
    ],
)
def test_a_scenario_that_cannot_be_names_the_key(robot, said, tmp_path, capsys):
    (tmp_path / "x.toml").write_text(OTHERWISE + robot)
    assert said in refused(capsys, "robot", "--scenario", "x.toml")


def test_an_arm_whose_shapes_are_not_installed_says_what_to_install(capsys, monkeypatch):
    model.cache_clear()
    monkeypatch.setattr(catalogue, "installed", lambda package: None)
    try:
        said = refused(capsys, "ur", "emulator", "--model", "ur5e")
    finally:
        model.cache_clear()
    assert said.endswith(
        "the shapes of the UR5e are missing: install farhand[ur-e], or the package airo-models"
    )
