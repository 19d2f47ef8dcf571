"""A pytest plugin for those whose controller or robot is under test: scenarios over bad networks, in virtual
time, the same bytes every time.

    @pytest.mark.farhand(scenario="point-obstacle", network="trace:office.csv")
    def test_my_controller(farhand):
        farhand.run(controller=MyController()).check()

Marker, all optional: `scenario` (name, TOML file or Scenario), `network` or `uplink` and `downlink` (SPECs, in
place of the scenario's own), `seed`, `settings` (by dotted key), `time_limit` (s), `computing_time` (s).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from farhand.laboratory.simulation import SimulationResult
    from farhand.operator_side.control.controller import Controller
    from farhand.robot_side.robots.robot import Robot
    from farhand.runs.run import Run
    from farhand.runs.scenario import Scenario
    from farhand.runs.summary import RunSummary

KEYWORDS = (
    "scenario",
    "network",
    "uplink",
    "downlink",
    "seed",
    "settings",
    "time_limit",
    "computing_time",
)


@dataclass
class Settings:
    """What the marker says, with its defaults."""

    scenario: str | Scenario = "point-obstacle"
    network: str | None = None
    uplink: str | None = None
    downlink: str | None = None
    seed: int = 0
    settings: dict[str, object] = field(default_factory=dict)
    time_limit: float = 120.0
    computing_time: float = 0.02


@dataclass(frozen=True)
class FinishedRun:
    """A run and what can be demanded of it.

    Attributes:
        result: trajectory, reports of every tick, digest of every message.
    """

    result: SimulationResult

    @property
    def summary(self) -> RunSummary:
        """See RunSummary."""
        return self.result.summary

    def check(
        self,
        *,
        clearance: float | None = None,
        finished: bool = True,
        within: float | None = None,
        stops: int = 0,
    ) -> RunSummary:
        """Assert that the run was as it must be; the failure names the run, so that it can be had again.

        Args:
            clearance: smallest true clearance allowed (m); None takes the scenario's d_min.
            finished: whether all targets must have been reached.
            within: in at most this time (s).
            stops: latched stops allowed.
        """
        __tracebackhide__ = True
        summary = self.summary
        wrong = []
        least = summary.d_min if clearance is None else clearance
        if summary.min_clearance is not None and summary.min_clearance < least:
            wrong.append(f"clearance {summary.min_clearance * 1e3:.1f} mm, below {least * 1e3:g} mm")
        if summary.min_arm_clearance is not None and summary.min_arm_clearance <= 0.0:
            wrong.append(f"the arm touched an obstacle ({summary.min_arm_clearance * 1e3:.1f} mm)")
        if finished and not summary.finished:
            wrong.append(summary.why or "not finished")
        if within is not None and summary.duration > within:
            wrong.append(f"took {summary.duration:.1f} s, longer than {within:g} s")
        if summary.stops > stops:
            wrong.append(f"{summary.stops} stops, more than {stops}")
        if wrong:
            pytest.fail(f"{self._name()}: {'; '.join(wrong)}", pytrace=False)
        return summary

    def _name(self) -> str:
        s = self.summary
        return f"{s.scenario} over {s.network}, seed {s.seed}"


class Farhand:
    """What the fixture hands over.

    Args:
        settings: of the marker.
    """

    def __init__(self, settings: Settings) -> None:
        self._run = _run(settings)
        self.scenario = self._run.scenario

    def run(
        self, controller: Controller | None = None, robot: Robot | None = None, seed: int | None = None
    ) -> FinishedRun:
        """Run the marker's scenario in virtual time.

        Args:
            controller, robot: under test, fresh; None takes the scenario's.
            seed: in place of the marker's.
        """
        import msgspec

        from farhand.laboratory.simulation import simulate_run

        run = self._run if seed is None else msgspec.structs.replace(self._run, seed=seed)
        return FinishedRun(
            simulate_run(run, keep_reports=True, digest=True, controller=controller, robot=robot)
        )


def pytest_configure(config: pytest.Config) -> None:
    """Make the marker known."""
    config.addinivalue_line(
        "markers",
        "farhand(scenario, network, uplink, downlink, seed, settings, time_limit, computing_time): "
        "what the `farhand` fixture runs in virtual time",
    )


@pytest.fixture
def farhand(request: pytest.FixtureRequest) -> Farhand:
    """Runs the marker's scenario over its network in virtual time."""
    marker = request.node.get_closest_marker("farhand")
    words: dict[str, Any] = dict(marker.kwargs) if marker is not None else {}
    if marker is not None and marker.args:
        pytest.fail("@pytest.mark.farhand: takes keywords only, such as scenario=...", pytrace=False)
    for word in words:
        if word not in KEYWORDS:
            known = ", ".join(KEYWORDS)
            pytest.fail(f"@pytest.mark.farhand: {word!r} is none of {known}", pytrace=False)
    from farhand.common.errors import InputError

    try:
        return Farhand(Settings(**words))
    except InputError as error:
        pytest.fail(f"@pytest.mark.farhand: {error}", pytrace=False)


def _run(settings: Settings) -> Run:
    from farhand.runs.run import Run, choose_network, read_choice
    from farhand.runs.scenario import load_scenario, replace_setting

    found = settings.scenario
    scenario = load_scenario(found) if isinstance(found, str) else found
    for key, value in settings.settings.items():
        scenario = replace_setting(scenario, key, value)
    choice = read_choice(settings.network, settings.uplink, settings.downlink)
    return Run(
        scenario=scenario,
        network=choose_network(scenario, choice, where=found if isinstance(found, str) else ""),
        seed=settings.seed,
        time_limit=settings.time_limit,
        computing_time=(settings.computing_time,),
    )
