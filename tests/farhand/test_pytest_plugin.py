"""The pytest plugin, on the examples of its documentation: a good controller passes, a bad one fails."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
DOCUMENT = ROOT / "docs" / "experiments.md"

WRONG = """
import pytest

@pytest.mark.farhand(network="lunar:3")
def test_network(farhand):
    farhand.run()

@pytest.mark.farhand(scenery="point-obstacle")
def test_word(farhand):
    farhand.run()

@pytest.mark.farhand(settings={"controller.gama": 1})
def test_setting(farhand):
    farhand.run()

@pytest.mark.farhand("point-obstacle")
def test_positional(farhand):
    farhand.run()

@pytest.mark.farhand(network="constant:20", time_limit=5.0)
def test_unfinished(farhand):
    farhand.run().check()

@pytest.mark.farhand(network="constant:20", time_limit=5.0)
def test_demands(farhand):
    run = farhand.run()
    run.check(finished=False)
    run.check(finished=False, clearance=9.0, within=1.0)
"""


def run_pytest(folder: Path, text: str) -> subprocess.CompletedProcess[str]:
    (folder / "test_example.py").write_text(text)
    (folder / "pytest.ini").write_text("[pytest]\naddopts = --strict-markers\nfilterwarnings = error\n")
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("PYTEST", "COV"))}
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_example.py"],
        capture_output=True,
        text=True,
        cwd=folder,
        env=environment | {"PYTHONPATH": str(ROOT)},
        check=False,
    )


@pytest.mark.long
def test_the_documented_example_fails_for_the_bad_controller(tmp_path):
    blocks = re.findall(r"```python\n(.*?)```", DOCUMENT.read_text(encoding="utf-8"), re.DOTALL)
    example = next(block for block in blocks if "pytest.mark.farhand" in block)
    done = run_pytest(tmp_path, example)
    said = done.stdout
    assert done.returncode == 1, said + done.stderr
    assert "1 failed, 2 passed" in said
    failed = re.search(r"point-obstacle over constant:200, seed 0: took [\d.]+ s, longer than 60 s", said)
    assert failed, said
    assert failed[0] in DOCUMENT.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "line",
    [
        r"lunar",
        r"'scenery' is none of scenario, network",
        r"gama",
        r"takes keywords only",
        r"seed 0: not finished within 5 s: 0 of 3 targets reached",
        r"below 9000 mm; took 5\.\d s, longer than 1 s",
    ],
)
def test_what_is_wrong_is_said_in_one_line(line, wrong):
    assert re.search(line, wrong), wrong


@pytest.fixture(scope="module")
def wrong(tmp_path_factory) -> str:
    done = run_pytest(tmp_path_factory.mktemp("wrong"), WRONG)
    assert "2 failed, 4 errors" in done.stdout, done.stdout + done.stderr
    return done.stdout
