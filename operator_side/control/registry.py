"""From settings to a controller. To add one: one small file, one line here, one name in common/scenario.py.

Solvers are imported only when chosen, so that a program starts fast.
"""

from msgspec import structs

from farhand.common.errors import InputError
from farhand.common.scenario import ControllerSettings
from farhand.operator_side.control.controller import Controller


def make_controller(settings: ControllerSettings) -> Controller:
    """The controller that the settings ask for; raises InputError for a kind that does not exist.

    Where it cannot be quite what was asked for, the controller's `solver_notice` says so in one line.
    """
    if settings.kind == "pass-through":
        from farhand.operator_side.control.baselines.pass_through import PassThrough

        return PassThrough(settings)
    if settings.kind == "one-step":
        from farhand.operator_side.control.baselines.one_step import OneStep

        return OneStep(settings)
    if settings.kind == "mpc-distance":
        from farhand.operator_side.control.baselines.mpc_distance import distance_settings

        return _mpc(distance_settings(settings))
    if settings.kind == "mpc-cbf":
        return _mpc(settings)
    raise InputError(
        f"controller.kind: {settings.kind!r} is none of mpc-cbf, pass-through, one-step, mpc-distance"
    )


def _mpc(settings: ControllerSettings) -> Controller:
    notice = ""
    if settings.solver == "newton":
        try:
            from farhand.operator_side.control.newton import NewtonController

            return NewtonController(settings)
        except ImportError as error:
            notice = f"the compiled solver cannot be used ({error}); the slower CasADi SQP takes over"
            settings = structs.replace(settings, solver="sqp")
    if settings.solver == "sqp":
        from farhand.operator_side.control.sqp import SqpController

        sqp = SqpController(settings)
        sqp.solver_notice = notice
        return sqp
    if settings.solver == "ipopt":
        from farhand.operator_side.control.ipopt import IpoptController

        return IpoptController(settings)
    raise InputError(f"controller.solver: {settings.solver!r} is none of newton, sqp, ipopt")
