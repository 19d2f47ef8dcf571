"""What `make` says before it installs anything, with Pythons and a compiler that are there by name only."""

import shutil
import subprocess
import sys

import pytest

from tests.installed import ROOT

TOOLS = ("sh", "dirname", "sed", "tr", "ls", "mkdir", "rm")


@pytest.fixture
def place(tmp_path):
    """A checkout of which the set-up needs no more, and a PATH with what every machine has."""
    (tmp_path / "scripts").mkdir()
    shutil.copy(ROOT / "scripts" / "make-environment.sh", tmp_path / "scripts")
    (tmp_path / "requirements.lock").write_text("pin==3.3.0\npybullet==3.2.7\n")
    (tmp_path / "bin").mkdir()
    for tool in TOOLS:
        (tmp_path / "bin" / tool).symlink_to(shutil.which(tool))
    return tmp_path


def executable(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)


def python(path, minor):
    """One that calls itself 3.MINOR, has no headers, and ends with 7 where it is to do more than answer."""
    version = f"import sys; sys.version_info = (3, {minor}, 0, 'final', 0)"
    headers = "import sysconfig; sysconfig.get_path = lambda name: '/nowhere'"
    executable(
        path,
        f'[ "$1" = -c ] || {{ [ "$2 $3" = "pip --version" ]; exit $(($? * 7)); }}\n'
        f'exec {sys.executable} -S -E -c "{version}; {headers}; exec(sys.argv[1])" "$2"',
    )


def set_up(place, **variables):
    environment = {"PATH": str(place / "bin"), "HOME": str(place), **variables}
    return subprocess.run(
        ["sh", "scripts/make-environment.sh"], cwd=place, env=environment, capture_output=True, text=True
    )


def last(done):
    return done.stderr.splitlines()[-1]


def test_without_a_python_that_will_do_it_says_how_to_get_one(place):
    python(place / "bin" / "python3", 9)
    done = set_up(place)
    assert done.returncode == 2
    assert last(done).startswith("farhand: no Python 3.10 to 3.14 found; install one")


def test_3_11_goes_before_what_has_to_be_built(place):
    python(place / "bin" / "python3", 13)
    python(place / "bin" / "python3.11", 11)
    done = set_up(place)
    assert done.returncode == 7
    assert "pybullet" not in done.stdout


def test_time_and_compiler_are_said_before_anything_is_built(place):
    python(place / "bin" / "python3", 13)
    done = set_up(place)
    assert done.returncode == 2
    assert "no wheel for Python 3.13: it is built from its source, once" in done.stdout
    assert last(done).endswith("needs a C++ compiler; on Debian and Ubuntu: apt install g++ python3.13-dev")
    executable(place / "bin" / "c++", "")
    assert last(set_up(place)).endswith(
        "needs the headers of Python 3.13; on Debian and Ubuntu: apt install g++ python3.13-dev"
    )
    assert not (place / ".venv").exists()


@pytest.mark.parametrize(
    ("kept", "builds"), [("3.2.7-cp313", False), ("3.2.7-cp312", True), ("3.2.6-cp313", True)]
)
def test_only_a_kept_wheel_that_pip_would_take_saves_the_building(place, kept, builds):
    python(place / "bin" / "python3", 13)
    wheels = place / ".cache" / "farhand" / "wheels"
    wheels.mkdir(parents=True)
    (wheels / f"pybullet-{kept}-{kept[-5:]}-linux_x86_64.whl").touch()
    assert ("has no wheel" in set_up(place).stdout) == builds


def test_an_environment_that_stays_is_what_the_wheel_is_for(place):
    python(place / "bin" / "python3.11", 11)
    python(place / ".venv" / "bin" / "python", 13)
    done = set_up(place)
    assert "no wheel for Python 3.13" in done.stdout
    assert done.returncode == 2
    assert (place / ".venv").exists()


def test_another_version_that_is_asked_for_takes_its_place(place):
    python(place / "bin" / "python3.11", 11)
    python(place / ".venv" / "bin" / "python", 13)
    done = set_up(place, PYTHON="python3.11")
    assert done.returncode == 7
    assert "pybullet" not in done.stdout
    assert not (place / ".venv").exists()
