"""Scenario files."""

from collections.abc import Callable
from pathlib import Path

from farhand.common.errors import InputError
from farhand.runs import scenario as module
from farhand.runs.scenario import parse_scenario, scenario_to_table
from farhand.trials.fuzz.target import Target, check, one_line

BUILT_IN = Path(module.__file__).resolve().parents[1] / "scenarios"


def seeds() -> list[bytes]:
    """The built-in ones."""
    return [path.read_bytes() for path in sorted(BUILT_IN.glob("*.toml"))]


def start() -> Callable[[bytes], None]:
    """See Target."""

    def take(data: bytes) -> None:
        try:
            scenario = parse_scenario(data.decode("utf-8", "replace"), "fuzz")
        except InputError as error:
            one_line(error)
            return
        check(scenario.safety.max_age > 0.0, "a limit is not positive")
        scenario_to_table(scenario)

    return take


TARGET = Target(
    edge="scenario TOML",
    promise="a refusal is one line",
    seeds=seeds,
    start=start,
    shape="text",
)
