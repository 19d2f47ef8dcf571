"""Where a tick of virtual time goes, part by part: processor time per period of the robot, which adds up to the run's.

`python -m benchmarks.virtual_parts [SCENARIO ...] [--quick] [--json FILE]`. Every part has a stopwatch that stops that
of the part around it; what a stopwatch takes on its own is taken off. Each run is made without them as well: by how
much the parts are more than that is what they cost the rest, a row of its own, so that all rows add up to the run.
Compare the parts of a run with one another: others on the machine slow all of them down.
"""

import argparse
import json
import statistics
import sys
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from farhand.common.timing.clock import thread_seconds
from farhand.laboratory.simulation import simulate
from farhand.laboratory.virtual_executor import VirtualExecutor
from farhand.netem.netem_node import NetemNode
from farhand.operator_side.control.newton import NewtonController
from farhand.operator_side.operator_node import OperatorNode
from farhand.robot_side.arm.chain import ArmChain
from farhand.robot_side.robot_node import RobotNode
from farhand.robot_side.robots.arm_follower import ArmFollower
from farhand.robot_side.robots.bullet import quiet
from farhand.robot_side.robots.pybullet_arm import ArmRobot
from farhand.runs.run import TIME_LIMIT
from farhand.runs.scenario import Scenario, load_scenario, replace_setting

with quiet():
    import pybullet

NETWORK = "uniform:50,200"
REPEATS = 3
SHORT = 0.5
OWN = "start and end of the run"
PARTS: tuple[tuple[Any, str, str], ...] = (
    (pybullet, "stepSimulation", "PyBullet: step"),
    (pybullet, "setJointMotorControlArray", "PyBullet: motors set"),
    (pybullet, "getJointStates", "PyBullet: joints read"),
    (ArmFollower, "follow", "velocity law, or guard"),
    (ArmChain, "refresh", "kinematics"),
    (ArmRobot, "step", "rest of the arm's step"),
    (ArmRobot, "arm_clearance", "arm's clearance, for a state"),
    (ArmRobot, "held_by", "what holds the arm, for a state"),
    (RobotNode, "_send_state", "rest of sending a state"),
    (RobotNode, "step", "rest of the robot's tick"),
    (NetemNode, "step", "emulated network"),
    (NewtonController, "solve", "operator: solver"),
    (OperatorNode, "step", "operator: rest of its tick"),
    (VirtualExecutor, "run_until", "executor"),
)
"""Whose function, its name, and what it is called: each without those of the list that it calls."""


class Stopwatches:
    """Time of each part without the parts within it.

    Attributes:
        spent: s, by part.
        calls: by part.
    """

    def __init__(self) -> None:
        self.spent: defaultdict[str, float] = defaultdict(float)
        self.calls: Counter[str] = Counter()
        self._running = OWN
        self._since = 0.0

    def start(self) -> None:
        """Begin anew, with nothing that is measured."""
        self.spent.clear()
        self.calls.clear()
        self._running, self._since = OWN, thread_seconds()

    def switch(self, part: str) -> str:
        """Stop what runs, start another; returns what ran."""
        now, before = thread_seconds(), self._running
        self.spent[before] += now - self._since
        self._running, self._since = part, now
        return before

    def around(self, part: str, call: Callable[..., Any]) -> Callable[..., Any]:
        """The same function, measured as a part."""

        def measured(*args: Any, **kwargs: Any) -> Any:
            self.calls[part] += 1
            before = self.switch(part)
            try:
                return call(*args, **kwargs)
            finally:
                self.switch(before)

        return measured


@contextmanager
def measured(watches: Stopwatches) -> Iterator[None]:
    """All parts have their stopwatches."""
    plain = [(owner, name, getattr(owner, name)) for owner, name, _ in PARTS]
    for owner, name, part in PARTS:
        setattr(owner, name, watches.around(part, getattr(owner, name)))
    try:
        yield
    finally:
        for owner, name, call in plain:
            setattr(owner, name, call)


def toll() -> tuple[float, float]:
    """What a stopwatch adds to its own part and to the one around it (s a call)."""
    watches, calls = Stopwatches(), 20_000
    nothing = watches.around("nothing", lambda: None)
    watches.start()
    for _ in range(calls):
        nothing()
    watches.switch(OWN)
    return watches.spent["nothing"] / calls, watches.spent[OWN] / calls


def outer(part: str) -> str:
    """The part whose functions call those of a part."""
    if part.startswith(("PyBullet", "velocity", "kinematics")):
        return "rest of the arm's step"
    return {
        "rest of the arm's step": "rest of the robot's tick",
        "arm's clearance, for a state": "rest of sending a state",
        "what holds the arm, for a state": "rest of sending a state",
        "rest of sending a state": "rest of the robot's tick",
        "operator: solver": "operator: rest of its tick",
        "executor": OWN,
    }.get(part, "executor")


def run(scenario: Scenario, seed: int, time_limit: float) -> float:
    """Do it; returns its virtual seconds."""
    return simulate(scenario, network=NETWORK, seed=seed, time_limit=time_limit).summary.duration


def parts(scenario: Scenario, repeats: int, time_limit: float) -> tuple[dict[str, float], float, float]:
    """Microseconds a tick of each part, and of the whole without stopwatches; times real time. Medians of repeats."""
    run(scenario, 0, SHORT)  # what is compiled, or loaded
    watches, found, whole, ratio = Stopwatches(), list[dict[str, float]](), list[float](), list[float]()
    for seed in range(repeats):
        began = thread_seconds()
        duration = run(scenario, seed, time_limit)
        spent = thread_seconds() - began
        own, around = toll()
        with measured(watches):
            watches.start()
            run(scenario, seed, time_limit)
            watches.switch(OWN)
        rest, ticks = defaultdict(float, watches.spent), watches.calls["rest of the robot's tick"]
        for part, calls in watches.calls.items():
            rest[part] -= own * calls
            rest[outer(part)] -= around * calls
        found.append({part: 1e6 * rest[part] / ticks for part in (*(part for *_, part in PARTS), OWN)})
        whole.append(1e6 * spent / ticks)
        ratio.append(duration / spent)
    medians = {part: statistics.median(each[part] for each in found) for part in found[0]}
    return medians, statistics.median(whole), statistics.median(ratio)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("scenarios", nargs="*", default=["ur5-obstacle", "panda-obstacle"])
    parser.add_argument("--quick", action="store_true", help="to see that it works; the figures mean nothing")
    parser.add_argument("--json", type=Path, help="write the results here as well")
    options = parser.parse_args()
    repeats, limit = (1, SHORT) if options.quick else (REPEATS, TIME_LIMIT)
    results: dict[str, dict[str, list[float]]] = {}
    for name in options.scenarios[:1] if options.quick else options.scenarios:
        off, on = (
            parts(replace_setting(load_scenario(name), "guard.on", guard), repeats, limit)
            for guard in (False, True)
        )
        rows = {part: [off[0][part], on[0][part]] for part in off[0]}
        rows["what the stopwatches cost the rest"] = [each[1] - sum(each[0].values()) for each in (off, on)]
        rows["the same runs without them"] = [off[1], on[1]]
        rows["times real time"] = [off[2], on[2]]
        results[name] = rows
        print(f"{name:36s} guard off    on   us a tick")
        for title, (without, guarded) in rows.items():
            print(f"  {title:36s} {without:7.2f} {guarded:7.2f}")
    if options.json is not None:
        options.json.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
