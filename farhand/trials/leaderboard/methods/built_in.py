"""The methods that come with Farhand: Farhand's own, the paper's, and what the literature has beside them.

"The paper" is arXiv 2403.18650. What a method is made of, each a file of its own, says where its equations are from.
"""

from collections.abc import Mapping
from typing import ClassVar

from farhand.laboratory.campaigns.tasks import PAPERS_EFFORT
from farhand.runs.scenario import Scenario
from farhand.trials.leaderboard.methods.method import Method

_BARE = {"margin.kind": "none", "operator.predictor": "none"}
FULL_UNTIL = 0.1
"""Round trip up to which nothing is slowed (s)."""
_PAPERS_STATE = {"margin.kind": "none", "operator.predictor": "history"}


class Nothing(Method):
    """No filter at all."""

    says = "what is asked for is done"
    settings: ClassVar[Mapping[str, object]] = {
        **_BARE,
        "controller.kind": "pass-through",
        "guard.on": False,
    }


class Paper(Method):
    """MPC-CBF with the paper's weights, the margin by round trip, the prediction by the commands sent during one."""

    says = "MPC-CBF with the paper's margin and prediction"
    source = "arXiv 2403.18650"
    settings: ClassVar[Mapping[str, object]] = {
        "controller.r": PAPERS_EFFORT,
        "margin.kind": "paper",
        "operator.predictor": "history",
        "guard.on": False,
    }


class Ours(Method):
    """MPC-CBF, margin by what predictions get wrong, prediction by the robot's echo."""

    says = "Farhand's operator side: MPC-CBF, adaptive margin, timeline"
    source = "docs/solver.md"
    settings: ClassVar[Mapping[str, object]] = {"margin.kind": "adaptive", "guard.on": False}


class Guard(Method):
    """Nothing on the operator's side; the robot guards itself."""

    says = "Farhand's guard on the robot alone"
    source = "docs/guard.md"
    settings: ClassVar[Mapping[str, object]] = {
        **_BARE,
        "controller.kind": "pass-through",
        "guard.on": True,
    }


class Both(Method):
    """What Farhand does where nothing else is said."""

    says = "Farhand: both layers"
    source = "docs/architecture.md"
    settings: ClassVar[Mapping[str, object]] = {"margin.kind": "adaptive", "guard.on": True}


class DistanceMpc(Method):
    """The same MPC, but for the decay of the barrier."""

    says = "MPC with distance constraints, no barrier"
    source = "arXiv 2403.18650, its comparison"
    settings: ClassVar[Mapping[str, object]] = {
        **_PAPERS_STATE,
        "controller.kind": "mpc-distance",
        "controller.r": PAPERS_EFFORT,
        "guard.on": False,
    }


class OneStepBarrier(Method):
    """A filter that looks one step ahead."""

    says = "one-step barrier filter on the paper's prediction"
    source = "Ames et al., Control barrier functions: theory and applications, ECC 2019"
    settings: ClassVar[Mapping[str, object]] = {
        **_PAPERS_STATE,
        "controller.kind": "one-step",
        "guard.on": False,
    }


class WorstCase(Method):
    """MPC-CBF on the state as it came, all obstacles larger by the way of half a second."""

    says = "MPC-CBF, fixed margin for a round trip of 0.5 s"
    source = "ISO 13855:2010, S = K T + C"

    def settings_for(self, scenario: Scenario) -> Mapping[str, object]:
        """K is the greatest speed that is asked for in an axis."""
        return {
            "margin.kind": "worst-case",
            "margin.worst-case": {"speed": max(scenario.controller.speed_limit), "delay": 0.5},
            "guard.on": False,
        }


class KnownDelayBarrier(Method):
    """The one-step barrier on the state that a known, constant delay predicts."""

    says = "one-step barrier, predictor for a known delay"
    source = "Jankovic, ACC 2018; Molnar et al., IEEE TCST 31(4), 2023"
    settings: ClassVar[Mapping[str, object]] = {
        "margin.kind": "none",
        "operator.predictor": "known-delay",
        "controller.kind": "one-step",
        "guard.on": False,
    }


class SpeedScaling(Method):
    """The one-step barrier on the state as it came, driven slower as the round trip grows.

    The way of a round trip is then never longer than at the greatest speed in FULL_UNTIL; that way, and those of a
    control period and of the robot's lag, are what obstacles are larger by.
    """

    says = "one-step barrier, slower as the round trip grows, fixed margin for the way of it"
    source = "Ferrell, Sheridan, IEEE Spectrum 4(10), 1967; ISO 13855:2010"

    def settings_for(self, scenario: Scenario) -> Mapping[str, object]:
        """Whoever steers is slowed down."""
        steering = scenario.steering
        own = steering.own.get(steering.kind, {})
        reaction = FULL_UNTIL + scenario.controller.period + scenario.robot.lag
        return {
            "margin.kind": "worst-case",
            "margin.worst-case": {"speed": max(scenario.controller.speed_limit), "delay": reaction},
            "steering.kind": "paced",
            "steering.paced": {"device": steering.kind, "settings": own, "full_until": FULL_UNTIL},
            "controller.kind": "one-step",
            "guard.on": False,
        }
