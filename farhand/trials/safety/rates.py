"""The rates that are compared: the paper's 10 Hz, and two ways to 50 Hz.

| name | tick (s) | step of the plan (s) | steps | gamma |
|---|---|---|---|---|
| `10` | 0.1 | 0.1 | 10 | 0.5 |
| `50` | 0.02 | 0.1 | 10 | 0.5 |
| `50-short` | 0.02 | 0.02 | 50 | 0.13, the same barrier per second: 1 - 0.5 ** (0.02 / 0.1) |
"""

from typing import Literal

from farhand.runs.scenario import Scenario, replace_settings

Rate = Literal["10", "50", "50-short"]
RATES: tuple[Rate, ...] = ("10", "50", "50-short")


def with_rate(scenario: Scenario, rate: Rate) -> Scenario:
    """The scenario, decided at that rate; raises ScenarioError where its settings forbid it."""
    if rate == "10":
        return scenario
    if rate == "50":
        return replace_settings(scenario, {"operator.rate_hz": 50.0})
    settings = scenario.controller
    step = 0.02
    return replace_settings(
        scenario,
        {
            "controller.period": step,
            "controller.horizon": round(settings.horizon * settings.period / step),
            "controller.gamma": 1.0 - (1.0 - settings.gamma) ** (step / settings.period),
        },
    )
