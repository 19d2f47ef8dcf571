"""How much faster than real time the laboratory is, and where the time goes.

`python benchmarks/virtual_time.py [--quick] [--json FILE]`. One process, one core; ratios of virtual time to the
processor's are what to compare. Run it on an idle machine: others slow the caches down.
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

from farhand.common.timing.clock import thread_seconds
from farhand.laboratory.campaigns.tasks import make_task
from farhand.laboratory.simulation import simulate
from farhand.runs.run import TIME_LIMIT
from farhand.runs.scenario import Scenario, load_scenario, replace_setting

NETWORK = "uniform:50,200"
TARGETS: dict[str, tuple[float | None, float | None]] = {
    "point-obstacle": (100.0, 100.0),
    "box-obstacle": (100.0, 100.0),
    "ur5-obstacle": (40.0, 30.0),
    "panda-obstacle": (None, None),
}
"""Least ratio wanted without the guard, and with it."""
REPEATS = 5
SHORT = 0.5
"""s: enough to have everything compiled."""
ROOT = Path(__file__).resolve().parent.parent


def run(quick: bool = False) -> dict[str, object]:
    """All measurements as plain values; durations in s."""
    limit = SHORT if quick else TIME_LIMIT
    found = ratios(1 if quick else REPEATS, limit)
    robots = ("point",) if quick else ("point", "box")
    return {
        "network": NETWORK,
        "scenarios": found,
        "table1": {robot: tasks(robot, 1 if quick else 12, limit) for robot in robots},
        "shares": shares(load_scenario("box-obstacle"), limit),
    }


def ratios(repeats: int, time_limit: float) -> dict[str, dict[str, float | None]]:
    """Virtual over processor time, guard off and on: medians of repeats, of which each takes all in turn."""
    scenarios = {
        (name, guard): replace_setting(load_scenario(name), "guard.on", guard)
        for name in TARGETS
        for guard in (False, True)
    }
    found: dict[tuple[str, bool], list[float]] = {each: [] for each in scenarios}
    for scenario in scenarios.values():  # what is compiled, or loaded
        simulate(scenario, uplink=NETWORK, downlink=NETWORK, time_limit=SHORT)
    for seed in range(repeats):
        for each, scenario in scenarios.items():
            began = thread_seconds()
            result = simulate(scenario, uplink=NETWORK, downlink=NETWORK, seed=seed, time_limit=time_limit)
            found[each].append(result.summary.duration / (thread_seconds() - began))
    return {
        name: {
            "off": statistics.median(found[name, False]),
            "on": statistics.median(found[name, True]),
            "wanted_off": wanted[0],
            "wanted_on": wanted[1],
        }
        for name, wanted in TARGETS.items()
    }


def tasks(robot: str, count: int, time_limit: float) -> dict[str, float]:
    """Table I's tasks, one after the other."""
    virtual, began = 0.0, thread_seconds()
    for index in range(count):
        scenario = make_task(1, index, "box" if robot == "box" else "point")
        result = simulate(
            scenario, uplink=NETWORK, downlink=NETWORK, seed=index, time_limit=time_limit, digest=True
        )
        virtual += result.summary.duration
    spent = thread_seconds() - began
    return {"ratio": virtual / spent, "tasks_per_minute_and_core": 60.0 * count / spent}


def shares(scenario: Scenario, time_limit: float) -> dict[str, float]:
    """Share of the time spent in each package's own functions and in what it calls outside of Farhand."""
    profile = cProfile.Profile()
    profile.enable()
    simulate(scenario, uplink=NETWORK, downlink=NETWORK, seed=1, time_limit=time_limit)
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
    parser.add_argument("--quick", action="store_true", help="to see that it works; the figures mean nothing")
    options = parser.parse_args()
    found = run(options.quick)
    if options.json is not None:
        options.json.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    table = Table(title=f"virtual over real time, one core, {NETWORK} each way")
    for heading in ("", "guard off", "wanted", "guard on", "wanted", "tasks a minute"):
        table.add_column(heading, justify="right" if heading else "left")
    scenarios, campaigns, parts = found["scenarios"], found["table1"], found["shares"]
    assert isinstance(scenarios, dict)
    assert isinstance(campaigns, dict)
    assert isinstance(parts, dict)
    for name, each in scenarios.items():
        cells = (f"{value:.0f}" if value is not None else "" for value in each.values())
        off, on, wanted_off, wanted_on = cells
        table.add_row(name, off, wanted_off, on, wanted_on, "")
    for name, each in campaigns.items():
        rate = f"{each['tasks_per_minute_and_core']:.0f}"
        table.add_row(f"table1, {name}", f"{each['ratio']:.0f}", "", "", "", rate)
    console = Console(markup=False)
    console.print(table)
    console.print("own time: " + ", ".join(f"{name} {100 * share:.0f} %" for name, share in parts.items()))


if __name__ == "__main__":
    main()
