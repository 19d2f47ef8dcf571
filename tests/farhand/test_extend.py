"""Every package of docs/extend.md, installed beside Farhand from its wheel, and each command of the page run."""

import json
import re
import shlex
from pathlib import Path

import pytest

from tests.installed import ROOT

PAGE = (ROOT / "docs" / "extend.md").read_text(encoding="utf-8")
FILES = re.findall(r"^`([\w-]+/[\w.]+)`:\n\n```\w+\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
COMMANDS = [
    line.removeprefix("farhand ")
    for block in re.findall(r"^```sh\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
    for line in block.splitlines()
    if line.startswith("farhand ")
]
GROUPS = ("margins", "predictors", "controllers", "devices", "robots", "impairments", "trace_formats")
UNFINISHED = ("slow-near", "circle")
"""A controller that stops before obstacles, and a device that goes round in circles: neither reaches all targets."""


@pytest.fixture(scope="module")
def extended(installed, tmp_path_factory):
    """The environment, with every package of the page."""
    folder = tmp_path_factory.mktemp("packages")
    for name, text in FILES:
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
    packages = sorted({name.partition("/")[0] for name, _ in FILES})
    installed.install([folder / package for package in packages], folder / "wheels")
    return installed


def test_the_page_has_a_package_for_each_kind():
    pyprojects = [text for name, text in FILES if name.endswith("pyproject.toml")]
    assert sorted(re.findall(r'entry-points\."farhand\.(\w+)"', "".join(pyprojects))) == sorted(GROUPS)
    imports = re.findall(r"^(?:from|import) ([\w.]+)", "".join(text for _, text in FILES), re.MULTILINE)
    assert {name for name in imports if name.startswith("farhand")} == {"farhand"}  # public names alone


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize("command", COMMANDS, ids=lambda c: re.sub(r"[^\w]+", "-", c)[:60])
def test_each_command_of_the_page_runs(extended, command, tmp_path):
    done = extended.farhand(*shlex.split(command), cwd=_prepared(tmp_path))
    unfinished = any(word in command for word in UNFINISHED)
    assert done.returncode in ((0, 1) if unfinished else (0,)), done.stdout + done.stderr
    assert "Traceback" not in done.stdout + done.stderr
    if "table1" in command:
        assert sorted(path.name for path in (tmp_path / "runs" / "steady").glob("*.png"))
        assert "steady" in (tmp_path / "runs" / "steady" / "table1.md").read_text()


@pytest.mark.slow
@pytest.mark.long
def test_a_sweep_over_an_own_kind_and_its_setting(extended, tmp_path):
    (tmp_path / "sweep.toml").write_text(
        'scenario = "point-obstacle"\nnetwork = "constant:100"\nseeds = 1\ntime_limit = 5.0\n'
        '[grid]\n"margin.kind" = ["steady"]\n"margin.steady.metres" = [0.02, 0.2]\n'
    )
    done = extended.farhand("sweep", "sweep.toml", "--workers", "1", "--out", "out", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    lines = next((tmp_path / "out").glob("*.csv")).read_text().splitlines()
    assert len(lines) == 3
    assert "0.2" in lines[2]


@pytest.mark.slow
@pytest.mark.long
def test_an_own_kind_is_recorded_with_its_settings_and_replays(extended, tmp_path):
    words = ["--scenario", "point-obstacle", "--network", "constant:100", "--time-limit", "5", "--out", "run"]
    chosen = ["--margin", "steady", "--set", "margin.steady.metres=0.08"]
    assert extended.farhand("simulate", *words, *chosen, cwd=tmp_path).returncode == 1  # too short to finish
    assert 'kind = "steady"' in (tmp_path / "run" / "scenario.toml").read_text()
    replayed = extended.farhand("replay", "run", "--json", cwd=tmp_path)
    assert replayed.returncode == 0, replayed.stdout + replayed.stderr
    found = json.loads(replayed.stdout.splitlines()[-1])
    assert found["identical"] == found["ticks"] > 0


@pytest.mark.long
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--margin", "stedy"], "--margin 'stedy': no such margin law; is 'steady' meant?"),
        (
            ["--margin", "steady", "--set", "margin.steady.metres=wide"],
            "margin.steady.metres: expected `float`",
        ),
        (
            ["--margin", "steady", "--set", "margin.steady.mm=3"],
            "margin.steady: object contains unknown field `mm`",
        ),
        (
            ["--set", "robot.kind=cart", "--set", "robot.cart.wheels=4"],
            "robot.cart: object contains unknown field",
        ),
    ],
)
def test_bad_words_about_an_own_kind_end_in_one_line(extended, words, said, tmp_path):
    done = extended.farhand(
        "simulate", "--scenario", "point-obstacle", "--network", "none", *words, cwd=tmp_path
    )
    assert done.returncode == 2
    assert said in done.stderr
    assert done.stderr.count("\n") == 1


def _prepared(folder: Path) -> Path:
    """A folder with the files that commands of the page name."""
    for name, text in re.findall(r"^`([\w-]+\.\w+)`:\n\n```\w*\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE):
        (folder / name).write_text(text, encoding="utf-8")
    return folder
