"""No wall clock anywhere in the virtual path: the lint rule, the imports, and a run without any clock."""

import ast
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
CLOCKS = {"time", "datetime", "sched", "timeit"}

WITHOUT_CLOCKS = """
import time, datetime, sys
from farhand.runs.scenario import load_scenario, replace_setting
from farhand.laboratory.simulation import simulate
scenario = load_scenario("point-obstacle")
simulate(scenario, uplink="constant:50", downlink="constant:50", time_limit=0.5)  # compile
def refuse(*_):
    raise AssertionError("a clock was read in virtual time")
for name in ("time", "time_ns", "monotonic", "monotonic_ns", "clock_gettime_ns", "perf_counter", "perf_counter_ns",
             "process_time", "process_time_ns", "sleep", "localtime", "gmtime"):
    setattr(time, name, refuse)
import farhand.common.timing.clock
farhand.common.timing.clock.SystemClock.__init__ = refuse
for kind in ("point", "box"):
    scenario = load_scenario(f"{kind}-obstacle")
    result = simulate(scenario, uplink="gaussian:50,20 loss:5%", downlink="uniform:50,200", time_limit=5.0)
    assert result.summary.ticks > 40
names = [n for n in sys.modules if n.split(".")[0] in ("common", "operator_side", "netem", "robot_side", "farhand")]
print("\\n".join(sorted(names)))
"""


def test_a_run_reads_no_clock_and_no_module_on_its_path_imports_one():
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_CLOCKS], capture_output=True, text=True, cwd=ROOT, check=False
    )
    assert done.returncode == 0, done.stderr
    loaded = done.stdout.split()
    assert "farhand.operator_side.operator_node" in loaded
    assert "farhand.netem.netem_node" in loaded
    importers = []
    for name in loaded:
        path = ROOT / (name.replace(".", "/") + ".py")
        if path.exists() and CLOCKS & imported(path):
            importers.append(name)
    assert importers == ["farhand.common.timing.clock"]


def test_the_lint_rule_bans_clocks_sleep_and_global_randomness(tmp_path):
    bad = tmp_path / "bad.py"
    bad.write_text(
        '"""Bad."""\nimport time\nimport datetime\nimport random\nfrom asyncio import sleep\nimport numpy as np\n'
        "X = (time.time(), datetime.datetime, random, sleep, np.random.rand(), np.random.normal())\n"
    )
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "ruff",
            "check",
            "--no-cache",
            "--config",
            str(ROOT / "pyproject.toml"),
            "--select",
            "TID251",
            "--output-format",
            "concise",
            str(bad),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1, done.stderr
    lines = {int(line.split(":")[1]) for line in done.stdout.splitlines() if "TID251" in line}
    assert {2, 3, 4, 5, 7} <= lines


def imported(path: Path) -> set[str]:
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found.add(node.module.split(".")[0])
    return found
