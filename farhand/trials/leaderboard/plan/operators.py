"""Who steers: the paper's tester, a person as a model, an enemy."""

from dataclasses import dataclass

from farhand.runs.scenario import Scenario, replace_settings


@dataclass(frozen=True)
class Operator:
    """Attributes:
    says: what it is, in one line.
    kind: of the steering device.
    seeded: whether it draws.
    finishes: whether it has targets to reach; else it is enough that nothing happens.
    """

    says: str
    kind: str
    seeded: bool = False
    finishes: bool = True

    def applied_to(self, scenario: Scenario, seed: int) -> Scenario:
        """The scenario, steered by this one."""
        settings: dict[str, object] = {"steering.kind": self.kind}
        if self.seeded:
            settings[f"steering.{self.kind}"] = {"seed": seed}
        return replace_settings(scenario, settings)


OPERATORS = {
    "tester": Operator("the paper's: straight at the target, obstacles or not", "tester"),
    "person": Operator(
        "reacts after 0.22 s, overshoots, trembles, walks round (crossover model)", "person", seeded=True
    ),
    "hostile": Operator(
        "steers at obstacles for 20 s; success is that nothing happens",
        "hostile",
        seeded=True,
        finishes=False,
    ),
}
