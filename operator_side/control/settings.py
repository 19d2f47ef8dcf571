"""The settings of the safety filter."""

from typing import Annotated

from msgspec import Meta

from farhand.common.messages.base import NonNegative, Positive
from farhand.common.scenario.section import Fraction, KindSection


class ControllerSettings(KindSection, frozen=True, kw_only=True):
    """The safety filter; defaults are the paper's (arXiv 2403.18650) but for `r`, which is 1 there: with that the plan
    gives up r / (q + r), a tenth of every wish, where nothing is near.

    Attributes:
        kind: which controller.
        solver: which solver for `mpc-cbf`.
        horizon: N, steps.
        period: dt, a step of the plan, s; the operator's tick, too, where `operator.rate_hz` asks for no other.
        q, r, p, s: weights of tracking, effort, terminal tracking, smoothness.
        p_omega: weight of the relaxation of the decay rate.
        gamma: decay rate of the discrete barrier, in (0, 1].
        d_min: distance to keep (m).
        speed_limit: u_b for each axis (m/s).
        angular_limit: the tool is turned at most this fast, about whatever axis (rad/s).
        max_iterations: cap on solver iterations.
        wall_time_limit: for solvers that may run away (s).
    """

    kind: str = "mpc-cbf"
    solver: str = "newton"
    horizon: Annotated[int, Meta(ge=1, le=100)] = 10
    period: Annotated[float, Meta(ge=0.002, le=1)] = 0.1
    q: NonNegative = 10.0
    r: Positive = 0.1
    p: Positive = 10.0
    s: NonNegative = 10.0
    p_omega: Positive = 100.0
    gamma: Fraction = 0.5
    d_min: NonNegative = 0.01
    speed_limit: tuple[Positive, Positive, Positive] = (0.3, 0.3, 0.3)
    angular_limit: NonNegative = 1.0
    max_iterations: Annotated[int, Meta(ge=1, le=10_000)] = 30
    wall_time_limit: Positive = 0.08
