"""Scenarios: what the robot is, what it shall do among which obstacles, and every setting, as validated TOML.

SI units throughout (m, s, m/s, rad); `_hz` names a rate.
"""

import math
import os
import sys
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta, Struct

from farhand.common.errors import ScenarioError
from farhand.common.geometry import distance
from farhand.common.messages.base import NonNegative, Positive, Real, Vector3
from farhand.common.messages.scene import MAX_OBSTACLES, MAX_TARGETS, Obstacle

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

MarginName = Literal["none", "paper", "adaptive"]
PredictorName = Literal["none", "last-command", "history", "echo", "timeline"]
SolverName = Literal["newton", "sqp", "ipopt"]
ControllerName = Literal["mpc-cbf", "pass-through", "one-step", "mpc-distance"]
RobotKind = Literal["ur5", "box", "point"]
BUILT_IN = Path(__file__).resolve().parent.parent / "scenarios"

Fraction = Annotated[float, Meta(gt=0, le=1)]
Rate = Annotated[float, Meta(gt=0, le=10_000)]


class _Section(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    pass


class RobotSettings(_Section, frozen=True, kw_only=True):
    """The robot and its loops.

    Attributes:
        kind: `ur5` (PyBullet arm), `box` (PyBullet free-flying box), `point` (first-order lag, fast).
        radius: of the sphere around the tool that must stay clear (m).
        rate_hz: control and simulation rate.
        state_rate_hz: rate of RobotState messages.
        lag: time constant with which the tool follows a velocity command (s); for `point` it is the model,
            for the others the operator's compensation.
        joints: start configuration (rad); the inverse kinematics' seed when the start is elsewhere.
        velocity_control: `direction` (QP that keeps the direction) or `damped` (damped least squares).
        max_joint_acceleration: (rad/s^2).
    """

    kind: RobotKind = "ur5"
    radius: NonNegative = 0.05
    rate_hz: Rate = 500.0
    state_rate_hz: Rate = 100.0
    lag: Annotated[float, Meta(ge=0, le=2)] = 0.016
    joints: Annotated[tuple[Real, ...], Meta(min_length=6, max_length=6)] | None = None
    velocity_control: Literal["direction", "damped"] = "direction"
    max_joint_acceleration: Positive = 15.0


class SafetySettings(_Section, frozen=True, kw_only=True):
    """The watchdog on the robot.

    Attributes:
        max_age: a command built on a state older than this is refused (s).
        command_timeout: without a good command for this long, RUN becomes HOLD (s).
        stop_timeout: without a good command for this long, HOLD becomes STOPPED (s).
        lease_timeout: a silent holder loses control after this (s).
        max_speed: commands faster than this in any axis are refused (m/s).
    """

    max_age: Positive = 1.0
    command_timeout: Positive = 0.3
    stop_timeout: Positive = 1.5
    lease_timeout: Positive = 2.0
    max_speed: Positive = 2.0


class ControllerSettings(_Section, frozen=True, kw_only=True):
    """The safety filter; defaults are the paper's (arXiv 2403.18650).

    Attributes:
        kind: which controller.
        solver: which solver for `mpc-cbf`.
        horizon: N, steps.
        period: dt, s; also the period of the operator's tick.
        q, r, p, s: weights of tracking, effort, terminal tracking, smoothness.
        p_omega: weight of the relaxation of the decay rate.
        gamma: decay rate of the discrete barrier, in (0, 1].
        d_min: distance to keep (m).
        speed_limit: u_b for each axis (m/s).
        max_speed: v_max of the paper's margin (m/s).
        max_iterations: cap on solver iterations.
        wall_time_limit: for solvers that may run away (s).
    """

    kind: ControllerName = "mpc-cbf"
    solver: SolverName = "newton"
    horizon: Annotated[int, Meta(ge=1, le=100)] = 10
    period: Annotated[float, Meta(ge=0.002, le=1)] = 0.1
    q: NonNegative = 10.0
    r: Positive = 1.0
    p: Positive = 10.0
    s: NonNegative = 10.0
    p_omega: Positive = 100.0
    gamma: Fraction = 0.5
    d_min: NonNegative = 0.01
    speed_limit: tuple[Positive, Positive, Positive] = (0.3, 0.3, 0.3)
    max_speed: Positive = 0.52
    max_iterations: Annotated[int, Meta(ge=1, le=10_000)] = 30
    wall_time_limit: Positive = 0.08


class MarginSettings(_Section, frozen=True, kw_only=True):
    """Safety margins.

    Attributes:
        kind: `none`, `paper` (from the round trip) or `adaptive` (from innovations and spread).
        rtt_window: samples of the round-trip statistics.
        k_sigma: weight of the round trip's standard deviation in the paper's margin.
        innovation_window: samples of the innovation maximum.
        floor, cap: bounds of the adaptive inflation (m).
    """

    kind: MarginName = "adaptive"
    rtt_window: Annotated[int, Meta(ge=2, le=10_000)] = 30
    k_sigma: NonNegative = 1.0
    innovation_window: Annotated[int, Meta(ge=1, le=100_000)] = 100
    floor: NonNegative = 0.01
    cap: Positive = 0.4


class OperatorSettings(_Section, frozen=True, kw_only=True):
    """The operator's side.

    Attributes:
        predictor: which state prediction; None chooses `timeline` for the adaptive margin, else `history`.
        resync_after: with the oldest unanswered command older than this, a zero plan is sent (s).
        near, far: distances between which the tester's speed rises linearly (m).
        near_speed, far_speed: its speeds there (m/s).
        tolerance: a target counts as reached within this distance (m).
    """

    predictor: PredictorName | None = None
    resync_after: Positive = 0.8
    near: Positive = 0.15
    far: Positive = 0.50
    near_speed: Positive = 0.05
    far_speed: Positive = 0.50
    tolerance: Positive = 0.02


class NetworkSettings(_Section, frozen=True, kw_only=True):
    """Network SPECs for each direction, as on the command line."""

    uplink: str = "none"
    downlink: str = "none"


class Scenario(_Section, frozen=True, kw_only=True):
    """Everything about one run but its seed.

    Attributes:
        name: short name.
        description: one line.
        start: tool position at the start (m, base frame).
        targets: to be reached in order (m).
        obstacles: spheres, possibly moving.
    """

    name: Annotated[str, Meta(min_length=1, max_length=64)]
    description: str = ""
    start: Vector3
    targets: Annotated[tuple[Vector3, ...], Meta(min_length=1, max_length=MAX_TARGETS)]
    obstacles: Annotated[tuple[Obstacle, ...], Meta(max_length=MAX_OBSTACLES)] = ()
    robot: RobotSettings = RobotSettings()
    safety: SafetySettings = SafetySettings()
    controller: ControllerSettings = ControllerSettings()
    margin: MarginSettings = MarginSettings()
    operator: OperatorSettings = OperatorSettings()
    network: NetworkSettings = NetworkSettings()

    @property
    def predictor(self) -> PredictorName:
        """The prediction law in force."""
        if self.operator.predictor is not None:
            return self.operator.predictor
        return "timeline" if self.margin.kind == "adaptive" else "history"


def load_scenario(name_or_path: str) -> Scenario:
    """A built-in scenario by name, or one from a TOML file; raises ScenarioError with one clear line."""
    path = Path(name_or_path)
    if path.suffix == ".toml" or os.path.isfile(path):  # Path.is_file raises for a name that is too long
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise ScenarioError(f"scenario {name_or_path}: cannot be read: {error}") from None
        return parse_scenario(text, name_or_path)
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
    try:
        table = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise ScenarioError(f"scenario {where}: not valid TOML: {error}") from None
    return scenario_from_table(table, where)


def scenario_from_table(table: dict[str, Any], where: str) -> Scenario:
    """A scenario from nested dictionaries, validated and checked for sense."""
    bad = _non_finite_key(table, "")
    if bad:
        raise ScenarioError(f"scenario {where}: {bad}: must be a finite number")
    try:
        scenario = msgspec.convert(table, Scenario)
    except msgspec.ValidationError as error:
        raise ScenarioError(f"scenario {where}: {_name_key(str(error))}") from None
    _check_sense(scenario, where)
    return scenario


def scenario_to_table(scenario: Scenario) -> dict[str, Any]:
    """Nested dictionaries without nulls: what `scenario_from_table` reads, and TOML can hold."""
    table: dict[str, Any] = _without_nulls(msgspec.to_builtins(scenario))
    return table


def replace_setting(scenario: Scenario, dotted: str, value: object) -> Scenario:
    """The scenario with one setting replaced, e.g. `controller.gamma`; raises ScenarioError."""
    table = scenario_to_table(scenario)
    place: Any = table
    *parents, last = dotted.split(".")
    for key in parents:
        place = place.setdefault(key, {}) if isinstance(place, dict) else None
    if not isinstance(place, dict):
        raise ScenarioError(f"setting {dotted!r}: no such key in a scenario")
    place[last] = value
    return scenario_from_table(table, f"setting {dotted}")


def _without_nulls(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_nulls(v) for key, v in value.items() if v is not None}
    if isinstance(value, list | tuple):
        return [_without_nulls(v) for v in value]
    return value


def _name_key(text: str) -> str:
    """msgspec's message with the key in front: `robot.radius: expected float >= 0`."""
    message, separator, path = text.partition(" - at `$.")
    if not separator:
        return text[:1].lower() + text[1:]
    return f"{path.rstrip('`')}: {message[:1].lower()}{message[1:]}"


def _non_finite_key(value: Any, path: str) -> str:
    if isinstance(value, float) and not math.isfinite(value):
        return path
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in items:
        place = f"{path}[{key}]" if isinstance(value, list) else f"{path}.{key}" if path else str(key)
        found = _non_finite_key(inner, place)
        if found:
            return found
    return ""


def _check_sense(scenario: Scenario, where: str) -> None:
    seen: set[str] = set()
    keep = scenario.robot.radius + scenario.controller.d_min
    for index, obstacle in enumerate(scenario.obstacles):
        if obstacle.id in seen:
            raise ScenarioError(f"scenario {where}: obstacles[{index}].id: {obstacle.id!r} is there twice")
        seen.add(obstacle.id)
        gap = distance(scenario.start, obstacle.position) - obstacle.radius
        if gap < keep:
            raise ScenarioError(
                f"scenario {where}: start: lies {gap:.3f} m from obstacle {obstacle.id!r}; "
                f"at least robot.radius + controller.d_min = {keep:.3f} m is needed"
            )
    safety = scenario.safety
    if safety.stop_timeout < safety.command_timeout:
        raise ScenarioError(
            f"scenario {where}: safety.stop_timeout: {safety.stop_timeout} s is shorter than "
            f"safety.command_timeout, {safety.command_timeout} s"
        )
    if scenario.operator.far <= scenario.operator.near:
        raise ScenarioError(f"scenario {where}: operator.far: must be larger than operator.near")
