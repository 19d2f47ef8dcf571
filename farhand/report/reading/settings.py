"""The settings of a run that are not the defaults, and those in which two runs differ."""

from collections.abc import Mapping
from typing import Any

import msgspec

from farhand.common.kinds import Kinds
from farhand.operator_side.control.registry import CONTROLLERS
from farhand.operator_side.margins.registry import MARGINS
from farhand.operator_side.steering.registry import DEVICES
from farhand.robot_side.robots.registry import ROBOTS
from farhand.runs.scenario import Scenario

TASK = ("name", "description", "start", "targets", "obstacles")
NETWORK = "network"
"""Said by itself."""
KINDS: dict[str, Kinds[Any]] = {
    "robot": ROBOTS,
    "controller": CONTROLLERS,
    "margin": MARGINS,
    "steering": DEVICES,
}
Flat = dict[str, object]


def settings_of(scenario: Mapping[str, object]) -> Flat:
    """All settings by their dotted names, without the task itself."""
    return {
        key: value
        for section, table in scenario.items()
        if section not in TASK
        for key, value in _flat(section, table)
    }


def changed(scenario: Mapping[str, object]) -> dict[str, tuple[object, object]]:
    """Setting in force and default of each that differs; a default of None: there is none."""
    defaults = _defaults(scenario)
    own = settings_of(scenario)
    return {
        key: (value, defaults.get(key))
        for key, value in sorted(own.items())
        if not key.startswith(f"{NETWORK}.") and not _same(value, defaults.get(key))
    }


def differing(first: Mapping[str, object], second: Mapping[str, object]) -> dict[str, tuple[object, object]]:
    """What two scenarios say otherwise, the task included; None: one does not say it."""
    here, there = (
        settings_of(each) | {key: each.get(key) for key in TASK if key != "description"}
        for each in (first, second)
    )
    keys = sorted(set(here) | set(there))
    return {key: (here.get(key), there.get(key)) for key in keys if not _same(here.get(key), there.get(key))}


def _same(one: object, other: object) -> bool:
    """Tuples and lists are the same, and numbers whatever their kind."""
    if isinstance(one, list | tuple) and isinstance(other, list | tuple):
        return len(one) == len(other) and all(map(_same, one, other))
    return one == other


def _flat(prefix: str, node: object) -> list[tuple[str, object]]:
    if isinstance(node, Mapping):
        return [pair for key, value in node.items() for pair in _flat(f"{prefix}.{key}", value)]
    return [(prefix, node)]


def _defaults(scenario: Mapping[str, object]) -> Flat:
    """Of the sections, and of the kinds' own tables that the scenario has."""
    found: Flat = {}
    for entry in msgspec.structs.fields(Scenario):
        if entry.name in TASK or not isinstance(entry.default, msgspec.Struct):
            continue
        table = {k: v for k, v in msgspec.to_builtins(entry.default).items() if k != "own"}
        found |= dict(_flat(entry.name, table))
        said = scenario.get(entry.name)
        kinds = KINDS.get(entry.name)
        if kinds is None or not isinstance(said, Mapping):
            continue
        for name, own in said.items():
            if isinstance(own, Mapping) and name in kinds.names():
                found |= dict(_flat(f"{entry.name}.{name}", _own_defaults(kinds, name)))
    return found


def _own_defaults(kinds: Kinds[Any], name: str) -> Flat:
    settings = getattr(kinds.get(name), "Settings", None)
    try:
        return dict(msgspec.to_builtins(settings())) if settings is not None else {}
    except TypeError:  # one without a default
        return {}
