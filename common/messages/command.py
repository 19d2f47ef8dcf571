"""Operator to robot: a twist of the tool and the plan behind it."""

from typing import Annotated, Literal

from msgspec import Meta

from farhand.common.messages.base import Message, Stamp, Vector3

MAX_PLAN = 256

CommandMode = Literal["run", "hold", "estop", "acknowledge", "release"]


class VelocityCommand(Message, frozen=True, kw_only=True):
    """Operator to robot, once a tick.

    Attributes:
        mode: `run` moves; `hold` brakes; `estop` latches; `acknowledge` asks for control and clears a
            latched stop; `release` gives control up, or hands it over to `successor`.
        velocity: tool velocity now (m/s).
        angular: angular velocity of the tool now, about base's axes (rad/s).
        plan: the rest of the plan after `velocity`, one velocity a period (m/s).
        plan_angular: the same after `angular` (rad/s); what it does not say is zero, and it ends with `plan`.
        plan_period_ns: period of the plan.
        desired, desired_angular: what the operator wanted before filtering (m/s, rad/s).
        successor: with `release`: the waiting session that gets control (0: nobody).
    """

    mode: CommandMode
    velocity: Vector3
    angular: Vector3 = (0.0, 0.0, 0.0)
    plan: Annotated[tuple[Vector3, ...], Meta(max_length=MAX_PLAN)] = ()
    plan_angular: Annotated[tuple[Vector3, ...], Meta(max_length=MAX_PLAN)] = ()
    plan_period_ns: Annotated[int, Meta(ge=1_000_000, le=10_000_000_000)] = 100_000_000
    desired: Vector3 = (0.0, 0.0, 0.0)
    desired_angular: Vector3 = (0.0, 0.0, 0.0)
    successor: Stamp = 0
