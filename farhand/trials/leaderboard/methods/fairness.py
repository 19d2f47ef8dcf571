"""What a method may not change: the task, the robot, its limits, the network, who steers, and what counts as safe."""

from typing import Any

import msgspec

from farhand.operator_side.pace import pace_of
from farhand.runs.scenario import Scenario

_FREE = {"controller", "margin", "guard"}
"""Sections that are a method's own, but for _FIXED."""
_FIXED = {"controller": ("d_min",)}
_OPERATORS = {"predictor", "resync_after"}
"""Of the section `operator`, what is a method's own: at another rate it would meet other draws of the network."""


def what_is_not_a_methods(task: Scenario, changed: Scenario) -> str:
    """The first setting that differs and is none that a method may change, in words; empty if there is none.

    Args:
        task: what is to be done, and who steers.
        changed: the same with the method's settings.
    """
    for name in task.__struct_fields__:
        before, after = getattr(task, name), getattr(changed, name)
        if before == after:
            continue
        if name == "steering" and _is_paced(task, changed):
            continue
        if name == "operator":
            inner = _first_other(before, after, _OPERATORS)
        elif name in _FREE:
            inner = next(
                (key for key in _FIXED.get(name, ()) if getattr(before, key) != getattr(after, key)), ""
            )
        else:
            inner = _first_other(before, after, set()) if isinstance(before, msgspec.Struct) else name
            return _told(name, inner)
        if inner:
            return _told(name, inner)
    if pace_of(changed).tick != pace_of(task).tick:
        return _told("controller", "period")
    return ""


def _is_paced(task: Scenario, changed: Scenario) -> bool:
    """Whether who steers still does, slowed down as the round trip grows."""
    before, after = task.steering, changed.steering
    own: dict[str, Any] = after.own.get("paced", {})
    same = own.get("settings", {}) == before.own.get(before.kind, {})
    return after.kind == "paced" and own.get("device") == before.kind and same


def _first_other(before: Any, after: Any, free: set[str]) -> str:
    names = [name for name in before.__struct_fields__ if name not in free]
    return next((name for name in names if getattr(before, name) != getattr(after, name)), "")


def _told(section: str, key: str) -> str:
    name = key if key == section or not key else f"{section}.{key}"
    return (
        f"{name} is the task's, and none of what a method may change: [controller] [margin] [guard], "
        "operator.predictor, operator.resync_after, and steering.kind to paced"
    )
