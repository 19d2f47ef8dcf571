"""The controllers and the solvers of the MPC by name. A new one is one file and one line here, or an entry point.

Imported only when chosen, so that a program starts fast.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING

from msgspec import structs

from farhand.common.kinds import Kinds, made
from farhand.operator_side.control.settings import ControllerSettings

if TYPE_CHECKING:
    from farhand.operator_side.control.controller import Controller

CONTROLLERS: "Kinds[Callable[[ControllerSettings], Controller]]" = Kinds(
    "controller",
    "farhand.controllers",
    "farhand.operator_side.control.controller:Controller",
    {
        "mpc-cbf": "farhand.operator_side.control.registry:make_mpc",
        "pass-through": "farhand.operator_side.control.baselines.pass_through:PassThrough",
        "one-step": "farhand.operator_side.control.baselines.one_step:OneStep",
        "mpc-distance": "farhand.operator_side.control.baselines.mpc_distance:make_distance_mpc",
    },
)
SOLVERS: "Kinds[Callable[[ControllerSettings], Controller]]" = Kinds(
    "solver",
    "farhand.solvers",
    "farhand.operator_side.control.controller:Controller",
    {
        "newton": "farhand.operator_side.control.newton:NewtonController",
        "sqp": "farhand.operator_side.control.sqp:SqpController",
        "ipopt": "farhand.operator_side.control.ipopt:IpoptController",
    },
)


def make_controller(settings: ControllerSettings) -> "Controller":
    """The controller that the settings ask for; raises InputError for a kind that does not exist.

    Where it cannot be quite what was asked for, the controller's `solver_notice` says so in one line.
    """
    kind = CONTROLLERS.get(settings.kind, "controller.kind")
    return made(f"controller {settings.kind!r}", lambda: kind(settings))


def make_mpc(settings: ControllerSettings) -> "Controller":
    """MPC-CBF by the solver that the settings name."""
    try:
        return SOLVERS.get(settings.solver, "controller.solver")(settings)
    except ImportError as error:
        if settings.solver != "newton":
            raise
        sqp = SOLVERS.get("sqp")(structs.replace(settings, solver="sqp"))
        sqp.solver_notice = f"the compiled solver cannot be used ({error}); the slower CasADi SQP takes over"
        return sqp
