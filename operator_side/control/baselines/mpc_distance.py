"""Baseline: MPC with plain distance constraints h_j(x_i) >= sigma_j, no barrier decay."""

from msgspec import structs

from farhand.operator_side.control.controller import Controller
from farhand.operator_side.control.registry import make_mpc
from farhand.operator_side.control.settings import ControllerSettings


def distance_settings(settings: ControllerSettings) -> ControllerSettings:
    """Settings with which any MPC-CBF solver keeps distances only.

    With gamma = 1 the row h(x_{i+1}) - sigma >= omega (1 - gamma) h(x_i) is h(x_{i+1}) >= sigma, hard, and
    omega costs nothing.
    """
    return structs.replace(settings, gamma=1.0)


def make_distance_mpc(settings: ControllerSettings) -> Controller:
    """The baseline by the solver that the settings name."""
    return make_mpc(distance_settings(settings))
