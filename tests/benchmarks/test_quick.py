"""Every benchmark runs: nothing else would see that what it measures has changed its ways."""

import importlib
import json
import sys

import pytest

from benchmarks.__main__ import NAMES
from tests.examples import also

WITH_PROCESSES = ("netem", "ros2", "seat")
SLOW = ("robot_loop", "recording", "report", "solver")


def _run(name, folder, monkeypatch):
    file = folder / f"{name}.json"
    monkeypatch.setattr(sys, "argv", [name, "--quick", "--json", str(file)])
    importlib.import_module(f"benchmarks.{name}").main()
    assert json.loads(file.read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    "name",
    [
        *(also(name) if name in SLOW else name for name in NAMES if name not in WITH_PROCESSES),
        "solver_oracle",
    ],
)
def test_a_benchmark_runs(name, tmp_path, monkeypatch):
    _run(name, tmp_path, monkeypatch)


@pytest.mark.realtime
@pytest.mark.long
@pytest.mark.parametrize("name", WITH_PROCESSES)
def test_a_benchmark_with_processes_runs(name, tmp_path, monkeypatch):
    _run(name, tmp_path, monkeypatch)
