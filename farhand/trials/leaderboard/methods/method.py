"""What competes: settings of both sides, and the kinds that they name."""

import importlib
import sys
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from threading import RLock
from typing import Any, ClassVar

from farhand.common.errors import InputError, in_one_line
from farhand.common.kinds import Kinds
from farhand.operator_side.control.registry import CONTROLLERS
from farhand.operator_side.margins.registry import MARGINS
from farhand.operator_side.prediction.registry import PREDICTORS
from farhand.runs.scenario import Scenario, replace_settings
from farhand.trials.leaderboard.methods.fairness import what_is_not_a_methods

_GROUPS: dict[str, Kinds[Any]] = {
    "margins": MARGINS,
    "predictors": PREDICTORS,
    "controllers": CONTROLLERS,
}


class Method:
    """A method. One small file and an entry point in `farhand.methods`, or `module:Class` where methods are named.

    Attributes:
        says: what it is, in one line.
        source: of its equations.
        settings: of the scenario, e.g. {"margin.kind": "mine", "guard.on": False}.
        margins, predictors, controllers: kinds of its own by name, for `settings` to name.
    """

    says: ClassVar[str] = ""
    source: ClassVar[str] = ""
    settings: ClassVar[Mapping[str, object]] = {}
    margins: ClassVar[Mapping[str, type]] = {}
    predictors: ClassVar[Mapping[str, type]] = {}
    controllers: ClassVar[Mapping[str, type]] = {}

    def settings_for(self, scenario: Scenario) -> Mapping[str, object]:
        """The settings for one scenario: the task, its robot, and who steers are in it already."""
        return self.settings

    @contextmanager
    def known(self) -> Iterator[None]:
        """Its own kinds are there by name for so long, and those of no other method; one at a time in a process."""
        brought = [(kinds, getattr(self, group)) for group, kinds in _GROUPS.items() if getattr(self, group)]
        with ExitStack() as stack:
            if brought:
                stack.enter_context(_ONE_AT_A_TIME)
            for kinds, own in brought:
                for name, kind in own.items():
                    stack.enter_context(kinds.lent(name, kind))
            yield

    def kinds(self) -> list[type]:
        """Its own."""
        return [kind for group in _GROUPS for kind in getattr(self, group).values()]


_ONE_AT_A_TIME = RLock()


def applied(method: Method, scenario: Scenario) -> Scenario:
    """The scenario as a method does it, while its kinds are `known`, at the task's speed at most.

    Raises:
        InputError: a setting makes no sense, or is none that a method may change.
    """
    settings = dict(method.settings_for(scenario))
    changed = replace_settings(scenario, settings)
    reason = what_is_not_a_methods(scenario, changed)
    if reason:
        raise InputError(f"method {type(method).__qualname__}: {reason}")
    limits = zip(scenario.controller.speed_limit, changed.controller.speed_limit, strict=True)
    slower = [min(task, own) for task, own in limits]
    turns = min(scenario.controller.angular_limit, changed.controller.angular_limit)
    return replace_settings(changed, {"controller.speed_limit": slower, "controller.angular_limit": turns})


_HERE = "farhand.trials.leaderboard.methods.built_in:"
METHODS: Kinds[type[Method]] = Kinds(
    "method",
    "farhand.methods",
    "farhand.trials.leaderboard.methods.method:Method",
    {
        "nothing": _HERE + "Nothing",
        "paper": _HERE + "Paper",
        "ours": _HERE + "Ours",
        "guard": _HERE + "Guard",
        "both": _HERE + "Both",
        "mpc-distance": _HERE + "DistanceMpc",
        "one-step": _HERE + "OneStepBarrier",
        "worst-case": _HERE + "WorstCase",
        "known-delay": _HERE + "KnownDelayBarrier",
        "speed-scaling": _HERE + "SpeedScaling",
    },
)
"""In the order of the table."""


def method_named(name: str) -> Method:
    """A method by its name, or by `module:Class`; raises InputError."""
    kind = _imported(name) if ":" in name else METHODS.get(name, "--methods")
    try:
        method = kind()
    except Exception as error:
        raise InputError(f"--methods {name!r}: cannot be used: {in_one_line(error)}") from None
    for said in ("says", "source"):
        if not isinstance(getattr(method, said), str):
            raise InputError(f"--methods {name!r}: {said} is {getattr(method, said)!r}; it must be text")
    return method


def _imported(name: str) -> type[Method]:
    module, _, attribute = name.partition(":")
    if "" not in sys.path and str(Path.cwd()) not in sys.path:
        sys.path.insert(0, str(Path.cwd()))  # as `python -m` has it: the file lies where one works
    try:
        found = getattr(importlib.import_module(module), attribute)
    except (Exception, SystemExit) as error:  # whatever a stranger's module does at import
        raise InputError(
            f"--methods {name!r}: cannot be imported: {type(error).__name__}: {error}; expected module:Class"
        ) from None
    if not (isinstance(found, type) and issubclass(found, Method)):
        raise InputError(f"--methods {name!r}: is no subclass of farhand.Method")
    return found
