"""How much faster than real time the laboratory is, and where the time goes.

`python benchmarks/virtual_time.py [--json FILE] [--quick]`. One process, one core; ratios of virtual to real
time are what to compare. Run it on an idle machine.
"""

import argparse
import cProfile
import json
import pstats
import statistics
import sys
from pathlib import Path

from rich.console import Console
from rich.table import Table

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from farhand.common.timing.clock import processor_seconds
from farhand.laboratory.campaigns.tasks import make_task
from farhand.laboratory.simulation import simulate
from farhand.runs.scenario import Scenario, load_scenario

NETWORK = "uniform:50,200"
TARGETS = {"point-obstacle": 100.0, "box-obstacle": 100.0, "ur5-obstacle": 8.0}
"""Least ratio wanted of a scenario that has one."""
ROOT = Path(__file__).resolve().parent.parent


def run(quick: bool = False) -> dict[str, object]:
    """All measurements as plain values; durations in s."""
    scenarios = {name: load_scenario(name) for name in TARGETS}
    ratios = {name: ratio(scenario, 1 if quick else 5) for name, scenario in scenarios.items()}
    return {
        "network": NETWORK,
        "scenarios": ratios,
        "table1": {robot: tasks(robot, 2 if quick else 12) for robot in ("point", "box")},
        "shares": shares(scenarios["box-obstacle"]),
    }


def ratio(scenario: Scenario, repeats: int) -> dict[str, float | None]:
    """Virtual over real time, median of repeats; the first run, which compiles, is left out."""
    simulate(scenario, uplink=NETWORK, downlink=NETWORK, time_limit=1.0)
    found = []
    for seed in range(repeats):
        began = processor_seconds()
        result = simulate(scenario, uplink=NETWORK, downlink=NETWORK, seed=seed)
        found.append(result.summary.duration / (processor_seconds() - began))
    return {"ratio": statistics.median(found), "target": TARGETS.get(scenario.name)}


def tasks(robot: str, count: int) -> dict[str, float]:
    """Table I's tasks, one after the other."""
    virtual, began = 0.0, processor_seconds()
    for index in range(count):
        scenario = make_task(1, index, "box" if robot == "box" else "point")
        result = simulate(
            scenario, uplink=NETWORK, downlink=NETWORK, seed=index, time_limit=300.0, digest=True
        )
        virtual += result.summary.duration
    wall = processor_seconds() - began
    return {"ratio": virtual / wall, "tasks_per_minute_and_core": 60.0 * count / wall}


def shares(scenario: Scenario) -> dict[str, float]:
    """Share of the time spent in each package's own functions and in what it calls outside of Farhand."""
    profile = cProfile.Profile()
    profile.enable()
    simulate(scenario, uplink=NETWORK, downlink=NETWORK, seed=1)
    profile.disable()
    own: dict[str, float] = {}
    for (file, _, _), (_, _, seconds, _, _) in pstats.Stats(profile).stats.items():  # type: ignore[attr-defined]
        own[_package(file)] = own.get(_package(file), 0.0) + seconds
    total = sum(own.values())
    return {name: seconds / total for name, seconds in sorted(own.items(), key=lambda item: -item[1])}


def _package(file: str) -> str:
    try:
        return Path(file).relative_to(ROOT).parts[0]
    except ValueError:
        return "builtins and libraries"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--json", type=Path, help="write the results to this file")
    parser.add_argument("--quick", action="store_true", help="few repeats")
    options = parser.parse_args()
    found = run(options.quick)
    if options.json is not None:
        options.json.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    table = Table(title=f"virtual over real time, one core, {NETWORK} each way")
    for heading in ("", "ratio", "wanted", "tasks a minute"):
        table.add_column(heading, justify="right" if heading else "left")
    scenarios, campaigns, parts = found["scenarios"], found["table1"], found["shares"]
    assert isinstance(scenarios, dict)
    assert isinstance(campaigns, dict)
    assert isinstance(parts, dict)
    for name, each in scenarios.items():
        table.add_row(name, f"{each['ratio']:.0f}", f"{each['target']:g}", "")
    for name, each in campaigns.items():
        rate = f"{each['tasks_per_minute_and_core']:.0f}"
        table.add_row(f"table1, {name}", f"{each['ratio']:.0f}", "", rate)
    console = Console()
    console.print(table)
    console.print("own time: " + ", ".join(f"{name} {100 * share:.0f} %" for name, share in parts.items()))


if __name__ == "__main__":
    main()
