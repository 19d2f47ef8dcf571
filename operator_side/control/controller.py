"""The interface of every safety filter: a problem in, a plan and an honest status out. Nothing throws."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import Enum
from typing import ClassVar

import numpy as np

from farhand.common.geometry import Array
from farhand.common.scenario.section import NoSettings, Section
from farhand.operator_side.control.settings import ControllerSettings


class Status(str, Enum):
    """How a solve ended.

    OPTIMAL and SHORTCUT meet every constraint. ELASTIC: converged, but a constraint had to give.
    CAPPED: iterations ran out. INFEASIBLE: proven that no plan within the limits meets the first
    constraint. BAD_INPUT: something was not finite. FAILED: the solver itself gave up.
    """

    OPTIMAL = "optimal"
    SHORTCUT = "shortcut"
    ELASTIC = "elastic"
    CAPPED = "capped"
    INFEASIBLE = "infeasible"
    BAD_INPUT = "bad-input"
    FAILED = "failed"

    @property
    def good(self) -> bool:
        """Whether the plan meets every constraint."""
        return self in (Status.OPTIMAL, Status.SHORTCUT)


@dataclass(frozen=True, slots=True)
class ControlProblem:
    """One tick's problem, base frame.

    Attributes:
        position: (3,) start state, already predicted and compensated for lag (m).
        desired: (3,) desired velocity, held over the horizon (m/s).
        centres: (n, 3) obstacle centres at the start of the horizon, of a plane any of its points (m).
        radii: (n,) R_j = r_robot + r_j + d_min + inflation, of a plane without r_j (m).
        velocities: (n, 3) obstacle velocities (m/s).
        sigmas: (n,) the paper's margin, subtracted from h_j (m as printed there, acts in m^2; of a plane in m).
        normals: (n, 3) of planes, unit vectors out of what is solid; zero for spheres; None: all are spheres.
    """

    position: Array
    desired: Array
    centres: Array
    radii: Array
    velocities: Array
    sigmas: Array
    normals: Array | None = None

    @property
    def flat(self) -> Array:
        """(n,) 1 for planes, 0 for spheres."""
        if self.normals is None:
            return np.zeros(len(self.radii))
        flat: Array = np.any(self.normals != 0.0, axis=1).astype(float)
        return flat


@dataclass(frozen=True, slots=True)
class ControlSolution:
    """What a controller decided.

    Attributes:
        plan: (N, 3) velocities, the first to be applied now (m/s); always finite and within the limits.
        status: see Status.
        cost: of the plan; NaN where it has no meaning.
        violation: largest violation of a constraint (m^2), 0 if none.
        iterations: of the solver.
        binding: index of the obstacle whose constraint binds most, -1 if none.
    """

    plan: Array
    status: Status
    cost: float = float("nan")
    violation: float = 0.0
    iterations: int = 0
    binding: int = -1


class Controller(ABC):
    """A safety filter. One small file, and one line in registry.py or an entry point in `farhand.controllers`.

    `solve` never raises and never returns a non-finite plan.

    Args:
        settings: of the safety filter; the controller's own are `own_settings(settings, type(self), "controller")`.

    Attributes:
        Settings: the type of its own settings, read from the table `[controller.NAME]`.
        settings: those in force.
        solver_notice: one line for the user where this is not quite what the settings asked for, else empty.
    """

    Settings: ClassVar[type[Section]] = NoSettings

    def __init__(self, settings: ControllerSettings) -> None:
        self.settings = settings
        self.solver_notice = ""

    def prepare(self) -> None:  # noqa: B027 (most have nothing to prepare)
        """Compile and warm up; called before anything is connected."""

    @abstractmethod
    def solve(self, problem: ControlProblem) -> ControlSolution:
        """Decide one tick; may keep a warm start for the next."""

    def reset(self) -> None:  # noqa: B027 (most have nothing to forget)
        """Forget the warm start."""


def zero_plan(settings: ControllerSettings) -> Array:
    """(N, 3) of zero velocities."""
    return np.zeros((settings.horizon, 3))
