"""Scenarios: what the robot is, what it shall do among which obstacles, and every setting, as validated TOML.

The sections are typed by the sides that own them. SI units throughout (m, s, m/s, rad); `_hz` names a rate.
"""

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec

from farhand.common.errors import InputError, ScenarioError
from farhand.common.kinds import Kinds
from farhand.common.scenario.known_keys import explained, nearest_first
from farhand.common.scenario.reader import non_finite_key, without_nulls
from farhand.common.scenario.section import KindSection, checked_settings
from farhand.common.scenario.task import Task
from farhand.common.shapes.distance import distance_to
from farhand.common.toml import parse_toml, read_toml
from farhand.netem.settings import NetworkSettings
from farhand.operator_side.control.registry import CONTROLLERS, SOLVERS
from farhand.operator_side.control.settings import ControllerSettings
from farhand.operator_side.margins.registry import MARGINS
from farhand.operator_side.margins.settings import MarginSettings
from farhand.operator_side.pace import is_whole
from farhand.operator_side.prediction.registry import PREDICTORS
from farhand.operator_side.settings import OperatorSettings
from farhand.operator_side.steering.registry import DEVICES
from farhand.operator_side.steering.settings import SteeringSettings
from farhand.robot_side.camera.settings import CameraSettings
from farhand.robot_side.robots.registry import ROBOTS
from farhand.robot_side.robots.settings import FILES, RobotSettings
from farhand.robot_side.safety.guard.settings import GuardSettings
from farhand.robot_side.safety.settings import SafetySettings
from farhand.runs.obstacle_table import check_shapes, settled

BUILT_IN = Path(__file__).resolve().parent.parent / "scenarios"


class Scenario(Task, frozen=True, kw_only=True):
    """Everything about one run but its seed: a task, and the settings of both sides and the network."""

    robot: RobotSettings = RobotSettings()
    safety: SafetySettings = SafetySettings()
    guard: GuardSettings = GuardSettings()
    controller: ControllerSettings = ControllerSettings()
    margin: MarginSettings = MarginSettings()
    operator: OperatorSettings = OperatorSettings()
    steering: SteeringSettings = SteeringSettings()
    network: NetworkSettings = NetworkSettings()
    camera: CameraSettings = CameraSettings()

    @property
    def predictor(self) -> str:
        """Name of the prediction law in force."""
        return self.operator.predictor or MARGINS.get(self.margin.kind, "margin.kind").predictor


@dataclass(frozen=True, slots=True)
class _Kinds:
    """Attributes:
    section: of the scenario.
    settings: its type; what it has no field for are the kinds' own tables.
    kinds: what it may name.
    """

    section: str
    settings: type[KindSection]
    kinds: Kinds[Any]


_SECTIONS = (
    _Kinds("robot", RobotSettings, ROBOTS),
    _Kinds("controller", ControllerSettings, CONTROLLERS),
    _Kinds("margin", MarginSettings, MARGINS),
    _Kinds("steering", SteeringSettings, DEVICES),
)


def load_scenario(name_or_path: str) -> Scenario:
    """A built-in scenario by name, or one from a TOML file; raises ScenarioError with one clear line."""
    path = Path(name_or_path)
    if path.suffix == ".toml" or os.path.isfile(path):  # Path.is_file raises for a name that is too long
        table = read_toml(name_or_path, "scenario", ScenarioError)
        return scenario_from_table(_with_files_beside(table, path.parent), name_or_path, path.parent)
    built_in = BUILT_IN / f"{name_or_path}.toml"
    if name_or_path in built_in_names():
        return parse_scenario(built_in.read_text(encoding="utf-8"), f"{name_or_path}.toml")
    known = ", ".join(built_in_names())
    raise ScenarioError(f"scenario {name_or_path!r}: no such name or file; built in: {known}")


def built_in_names() -> list[str]:
    """Names of the scenarios that come with Farhand."""
    return sorted(path.stem for path in BUILT_IN.glob("*.toml"))


def parse_scenario(text: str, where: str) -> Scenario:
    """A scenario from TOML text; `where` names the source in errors."""
    return scenario_from_table(parse_toml(text, f"scenario {where}", ScenarioError), where)


def scenario_from_table(table: dict[str, Any], where: str, folder: Path = Path()) -> Scenario:
    """A scenario from nested dictionaries, validated and checked for sense; raises ScenarioError.

    Args:
        table: as TOML gives it.
        where: names the source in errors.
        folder: what the names of mesh files are relative to.
    """
    bad = non_finite_key(table)
    if bad:
        raise ScenarioError(f"scenario {where}: {bad}: must be a finite number")
    try:
        scenario = msgspec.convert(settled(_with_own_tables(table), folder), Scenario)
        _check_kinds(scenario)
        check_shapes(scenario.obstacles)
    except msgspec.ValidationError as error:
        said = explained(str(error), Scenario, hint=_hint(str(error)))
        raise ScenarioError(_told(where, said)) from None
    except InputError as error:
        raise ScenarioError(_told(where, str(error))) from None
    _check_sense(scenario, where)
    return scenario


def _told(where: str, said: str) -> str:
    """One line that names the key once: where one setting alone is replaced, it is in `where` already."""
    said = " ".join(said.split())  # a key may hold a line feed
    setting, place = where.removeprefix("setting "), said.partition(": ")[0]
    if setting != where and "," not in setting and f"{setting}.".startswith(f"{place}."):
        said = said.removeprefix(f"{place}: ")
    said = "".join(
        c if c.isprintable() else repr(c)[1:-1] for c in said
    )  # a key may hold whatever TOML lets it
    return f"scenario {where}: {said}"


def scenario_to_table(scenario: Scenario) -> dict[str, Any]:
    """Nested dictionaries without nulls: what `scenario_from_table` reads, and TOML can hold."""
    table: dict[str, Any] = without_nulls(msgspec.to_builtins(scenario))
    for entry in _SECTIONS:
        section = table[entry.section]
        section.update(section.pop("own"))
    return table


def replace_setting(scenario: Scenario, dotted: str, value: object) -> Scenario:
    """The scenario with one setting replaced, e.g. `controller.gamma`; raises ScenarioError."""
    return replace_settings(scenario, {dotted: value})


def replace_settings(scenario: Scenario, settings: Mapping[str, object]) -> Scenario:
    """The scenario with settings replaced, judged together, whatever their order; raises ScenarioError."""
    table = scenario_to_table(scenario)
    for dotted, value in settings.items():
        place: Any = table
        *parents, last = dotted.split(".")
        for key in parents:
            place = place.setdefault(key, {}) if isinstance(place, dict) else None
        if not isinstance(place, dict):
            sections = [name for name, section in table.items() if isinstance(section, dict)]
            known = ", ".join(nearest_first(parents[0], sections))
            raise ScenarioError(
                f"setting {dotted!r}: no such key in a scenario: {parents[0]!r} is no section; there are {known}"
            )
        place[last] = value
    names = ", ".join(settings)
    return scenario_from_table(table, f"setting {names}") if settings else scenario


def _with_own_tables(table: dict[str, Any]) -> dict[str, Any]:
    """The same with the kinds' tables gathered under `own`, where the sections have them."""
    found = dict(table)
    for entry in _SECTIONS:
        section = table.get(entry.section)
        if isinstance(section, dict):
            fields = set(entry.settings.__struct_fields__) - {"own"}
            own = {k: v for k, v in section.items() if isinstance(v, dict) and k not in fields}
            if "own" in section and "own" not in own:
                own["own"] = section["own"]  # is refused as what it is: no kind of that name
            found[entry.section] = {k: v for k, v in section.items() if k not in own} | {"own": own}
    return found


def _with_files_beside(table: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The same with the files of the robot's description by absolute path: they lie beside the scenario's file."""
    section = table.get("robot")
    if not isinstance(section, dict):
        return table
    files = {k: section[k] for k in FILES if isinstance(section.get(k), str) and section[k]}
    return table | {"robot": section | {k: str((folder / v).resolve()) for k, v in files.items()}}


def _check_kinds(scenario: Scenario) -> None:
    """Raise InputError unless every kind that is named exists and its settings fit."""
    for entry in _SECTIONS:
        section: KindSection = getattr(scenario, entry.section)
        if section.kind not in entry.kinds:
            entry.kinds.get(section.kind, f"{entry.section}.kind")
        for name, table in section.own.items():
            kind = entry.kinds.get(name, f"{entry.section}.{name}")
            checked_settings(table, kind, f"{entry.section}.{name}")
        if entry.kinds.is_outside(section.kind):
            kind = entry.kinds.get(section.kind)
            checked_settings(section.own.get(section.kind, {}), kind, f"{entry.section}.{section.kind}")
    if scenario.controller.solver not in SOLVERS:
        SOLVERS.get(scenario.controller.solver, "controller.solver")
    predictor = scenario.operator.predictor
    if predictor is not None and predictor not in PREDICTORS:
        PREDICTORS.get(predictor, "operator.predictor")


def _hint(text: str) -> str:
    """Where an unknown key of a section may belong."""
    match = re.search(r"unknown field `(\w+)` - at `\$\.(margin|steering)`", text)
    if match is None:
        return ""
    key, section = match.groups()
    kinds = next(entry.kinds for entry in _SECTIONS if entry.section == section)
    for name in kinds.names():
        if not kinds.is_outside(name) and key in kinds.get(name).Settings.__struct_fields__:
            return f"; the law's own settings are in its table: {section}.{name}.{key}".replace(
                "law", kinds.what
            )
    return ""


def _check_sense(scenario: Scenario, where: str) -> None:
    seen: set[str] = set()
    keep = scenario.robot.radius + scenario.controller.d_min
    for index, obstacle in enumerate(scenario.obstacles):
        if obstacle.id in seen:
            raise ScenarioError(f"scenario {where}: obstacles[{index}].id: {obstacle.id!r} is there twice")
        seen.add(obstacle.id)
        gap = distance_to(obstacle, scenario.start)
        if gap < keep:
            raise ScenarioError(
                f"scenario {where}: start: lies {gap:.3f} m from obstacle {obstacle.id!r}; "
                f"at least robot.radius + controller.d_min = {keep:.3f} m is needed"
            )
    _check_targets(scenario, where, keep)
    safety = scenario.safety
    fastest = max(scenario.controller.speed_limit)
    if fastest > safety.max_speed:
        raise ScenarioError(
            f"scenario {where}: controller.speed_limit: {fastest:g} m/s is above safety.max_speed, "
            f"{safety.max_speed:g} m/s, beyond which the robot refuses commands"
        )
    if scenario.controller.angular_limit > safety.max_angular_speed:
        raise ScenarioError(
            f"scenario {where}: controller.angular_limit: {scenario.controller.angular_limit:g} rad/s is above "
            f"safety.max_angular_speed, {safety.max_angular_speed:g} rad/s, beyond which the robot refuses commands"
        )
    rate_hz, step = scenario.operator.rate_hz, scenario.controller.period
    if rate_hz is not None and not is_whole(rate_hz, step):
        raise ScenarioError(
            f"scenario {where}: operator.rate_hz: controller.period, {step:g} s, is no whole number of ticks at "
            f"{rate_hz:g} Hz; {max(1, round(rate_hz * step)) / step:g} Hz would do"
        )
    if safety.stop_timeout < safety.command_timeout:
        raise ScenarioError(
            f"scenario {where}: safety.stop_timeout: {safety.stop_timeout} s is shorter than "
            f"safety.command_timeout, {safety.command_timeout} s"
        )
    if safety.lease_timeout < safety.stop_timeout:
        raise ScenarioError(
            f"scenario {where}: safety.lease_timeout: {safety.lease_timeout} s is shorter than "
            f"safety.stop_timeout, {safety.stop_timeout} s: who fell silent would lose control of a robot that is "
            "not stopped yet, and never would be"
        )


def _check_targets(scenario: Scenario, where: str, keep: float) -> None:
    """Raise ScenarioError where a target lies in an obstacle that stays, or nearer to it than may be driven."""
    for index, target in enumerate(scenario.targets):
        for obstacle in scenario.obstacles:
            gap = distance_to(obstacle, target)
            if gap < keep and not obstacle.moves:
                lies = f"{-gap:.3f} m inside" if gap < 0.0 else f"{gap:.3f} m from"
                raise ScenarioError(
                    f"scenario {where}: targets[{index}]: lies {lies} obstacle {obstacle.id!r}; "
                    f"at least robot.radius + controller.d_min = {keep:.3f} m is needed"
                )
