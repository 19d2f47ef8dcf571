"""The scenario of a recorded run as a replay needs it: the deciding side's kinds must be installed, no others.

Neither the robot nor the device is replayed: what they did is in the recording. So their kinds stand for
themselves no more where the package that brought them is not there.
"""

from pathlib import Path
from typing import Any

from farhand.common.errors import InputError, RunFileError
from farhand.common.kinds import Kinds
from farhand.common.recording.reader import RecordedRun
from farhand.operator_side.control.registry import CONTROLLERS, SOLVERS
from farhand.operator_side.margins.registry import MARGINS
from farhand.operator_side.prediction.registry import PREDICTORS
from farhand.operator_side.steering.registry import DEVICES
from farhand.robot_side.robots.registry import ROBOTS
from farhand.runs.scenario import Scenario, replace_settings, scenario_from_table

SECTIONS = ("controller", "margin", "operator")
"""Settings that a replay can change: those of the deciding side."""
_DECIDING: dict[str, Kinds[Any]] = {
    "controller.kind": CONTROLLERS,
    "controller.solver": SOLVERS,
    "margin.kind": MARGINS,
    "operator.predictor": PREDICTORS,
}
_NOT_REPLAYED: dict[str, tuple[Kinds[Any], str]] = {
    "robot": (ROBOTS, "point"),
    "steering": (DEVICES, "tester"),
}
_OWN_TABLES: dict[str, Kinds[Any]] = {
    "controller": CONTROLLERS,
    "margin": MARGINS,
    "robot": ROBOTS,
    "steering": DEVICES,
}


def scenario_of(run: RecordedRun, path: Path, settings: dict[str, object]) -> Scenario:
    """The recorded scenario with replacements.

    Args:
        run: as recorded.
        path: of it, for errors.
        settings: by dotted key, of the deciding side only.

    Raises:
        InputError: a setting makes no sense in a replay, or a kind that decided is not installed.
    """
    for key in settings:
        if key in ("controller.period", "operator.rate_hz"):
            raise InputError(f"--set {key}: a replay keeps the instants of the recorded ticks")
        if not any(key == section or key.startswith(f"{section}.") for section in SECTIONS):
            raise InputError(
                f"--set {key}: has no influence on decisions in a replay; can be of {', '.join(SECTIONS)}"
            )
    table: dict[str, Any] = {
        name: dict(section) if isinstance(section, dict) else section
        for name, section in run.info.scenario.items()
    }
    if run.info.solver:
        table.setdefault("controller", {})["solver"] = run.info.solver
    _say_windows_in_seconds(table)
    _put_in_place(table, settings)
    _leave_out_what_is_not_replayed(table)
    _check_installed(table, path)
    return replace_settings(scenario_from_table(table, f"of run {path}"), settings)


def _say_windows_in_seconds(table: dict[str, Any]) -> None:
    """Recordings of before have the margin's windows in ticks."""
    margin = table.get("margin")
    if not isinstance(margin, dict):
        return
    margin = table["margin"] = dict(margin)
    period = table.get("controller", {}).get("period", 0.1)
    for name in ("rtt", "innovation"):
        ticks = margin.pop(f"{name}_window", None)
        if ticks is not None:
            margin[f"{name}_span"] = ticks * period


def _put_in_place(table: dict[str, Any], settings: dict[str, object]) -> None:
    """The kinds that are replaced: those of the recording are not needed then."""
    for dotted, kinds in _DECIDING.items():
        section, key = dotted.split(".")
        name = settings.get(dotted)
        if isinstance(name, str) and name not in kinds:
            kinds.get(name, f"--set {dotted}")
        if name is not None and isinstance(table.get(section), dict):
            table[section][key] = name


def _leave_out_what_is_not_replayed(table: dict[str, Any]) -> None:
    for name, (kinds, stand_in) in _NOT_REPLAYED.items():
        section = table.get(name)
        if isinstance(section, dict) and section.get("kind", stand_in) not in kinds:
            section["kind"] = stand_in
    for name, kinds in _OWN_TABLES.items():
        section = table.get(name)
        if isinstance(section, dict):
            in_force = section.get("kind")
            own = [key for key, value in section.items() if isinstance(value, dict)]
            for key in own:
                if key not in kinds and key != in_force:
                    del section[key]


def _check_installed(table: dict[str, Any], path: Path) -> None:
    """Raise RunFileError for a kind of the deciding side that nobody brings."""
    for dotted, kinds in _DECIDING.items():
        section, key = dotted.split(".")
        within = table.get(section)
        name = within.get(key) if isinstance(within, dict) else None
        if isinstance(name, str) and name not in kinds:
            raise RunFileError(
                f"run {path}: {dotted}: the {kinds.what} {name!r} that decided is not installed; install the package "
                f"that brings it (its entry point is in the group {kinds.group}), or replace it"
            )
