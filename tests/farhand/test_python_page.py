"""docs/python.md is one script that runs as it stands, and says what the page says."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import farhand

TEXT = (Path(__file__).resolve().parents[2] / "docs" / "python.md").read_text(encoding="utf-8")
SCRIPT = "\n".join(re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL))


@pytest.fixture(scope="module")
def said(tmp_path_factory) -> list[str]:
    folder = tmp_path_factory.mktemp("page")
    (folder / "page.py").write_text(SCRIPT, encoding="utf-8")
    command = [sys.executable, "page.py"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    ticks = (folder / "ticks.csv").read_text().splitlines()
    assert ticks[0] == "tick,rtt,inflation,solve_time,binding"
    assert len(ticks) > 100
    return done.stdout.splitlines()


def test_the_script_says_what_the_page_promises(said):
    text = "\n".join(said)
    assert "gama" in said[0]
    assert "gamma" in said[0]
    assert said[1].startswith("safe True, ")
    assert len([line for line in said if re.match(r"(none|adaptive) +\d", line)]) == 6
    grown = re.search(r"at most (\d+) mm larger", text)
    assert grown
    assert 50 < int(grown[1]) < 200
    assert re.search(r"^True \d{3}$", text, re.MULTILINE)
    assert "loss:gilbert(2%,20%) gaussian:50,20" in said
    assert said[-1] == "round-trip 4"


def test_every_name_that_it_imports_is_public():
    named = re.findall(r"^from farhand import (.*)$", SCRIPT, re.MULTILINE)
    names = {name.strip() for line in named for name in line.split(",")}
    assert names > {"simulate", "replay", "MARGINS"}
    assert names <= set(farhand.__all__)
