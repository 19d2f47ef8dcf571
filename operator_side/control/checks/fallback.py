"""What the operator commands for each way in which a solve can end. docs/solver.md, "What is commanded"."""

import numpy as np
from numpy.typing import NDArray

from farhand.common.geometry import Array
from farhand.operator_side.control import barrier as rows
from farhand.operator_side.control.controller import ControlProblem, ControlSolution, Status, zero_plan
from farhand.operator_side.control.settings import ControllerSettings

NEAR = 2e-5  # m^2: closer than this to the margin counts as on it; a solver keeps its rows to half of this
_NO_PLAN = {
    Status.BAD_INPUT: "input not finite",
    Status.FAILED: "solver failed",
}
_REASON = {
    Status.OPTIMAL: "inside a margin",
    Status.SHORTCUT: "inside a margin",
    Status.ELASTIC: "a constraint had to give",
    Status.CAPPED: "solver ran out of iterations",
    Status.INFEASIBLE: "no velocity within the limits keeps the margin",
}


def safe_plan(
    problem: ControlProblem, solution: ControlSolution, settings: ControllerSettings
) -> tuple[Array, str]:
    """The (N, 3) plan to be sent (m/s), and the reason where it is not the solution's own (else empty).

    A good plan is sent as it is, unless it starts inside a margin. Any other plan is sent up to the first
    step that could drive deeper in (see harmless_steps), from there on it stands still: the robot plays out
    the rest of a plan when commands stop. BAD_INPUT and FAILED stand still. The pass-through baseline is
    left alone.
    """
    if solution.status in _NO_PLAN:
        return zero_plan(settings), _NO_PLAN[solution.status]
    if settings.kind == "pass-through":
        return solution.plan, ""
    good = solution.status.good
    if good and not _starts_inside(problem):
        return solution.plan, ""
    if not rows.input_is_good(problem) or not np.all(np.isfinite(solution.plan)):
        return zero_plan(settings), _NO_PLAN[Status.BAD_INPUT]
    steps = harmless_steps(problem, solution.plan, settings.period, 1.0 if good else settings.gamma)
    if steps == len(solution.plan):
        return solution.plan, ""
    plan = solution.plan.copy()
    plan[steps:] = 0.0
    what = "stopped" if steps == 0 else f"plan cut after {steps} steps"
    return plan, f"{_REASON[solution.status]}: {what}"


def harmless_steps(problem: ControlProblem, plan: Array, dt: float, gamma: float) -> int:
    """How many steps of the plan do not drive deeper into any margin.

    Step i with obstacle j, d = x_i - p_j(i):
        inside (h < sigma): h must not fall anywhere along the step (see _never_nearer);
        outside: h(x_{i+1}) - sigma >= (1 - gamma) (h(x_i) - sigma), so that h stays above sigma;
        either way a step is allowed that is nowhere nearer than standing still, for the obstacle may move.
    Of planes h is a height.

    Args:
        problem: the tick's problem.
        plan: (N, 3), m/s.
        dt: length of a step (s).
        gamma: decay rate outside; 1 demands h >= sigma only.
    """
    if not len(problem.radii):
        return len(plan)
    positions = rows.path(problem, plan, dt)
    stage = np.arange(len(plan))[:, None] * dt
    away = positions[None, :-1] - problem.centres[:, None] - stage * problem.velocities[:, None]
    motion = plan[None] - problem.velocities[:, None]
    still = np.broadcast_to(-problem.velocities[:, None], motion.shape)
    room = rows.values(problem, away) - problem.sigmas[:, None]  # h(x_i) - sigma
    room_next = rows.values(problem, away + dt * motion) - problem.sigmas[:, None]
    room_standing = rows.values(problem, away + dt * still) - problem.sigmas[:, None]
    keeps = _never_nearer(away, motion, still, dt)
    if problem.normals is not None:
        up, up_standing = (np.einsum("jk,jik->ji", problem.normals, w) for w in (motion, still))
        keeps = np.where(problem.flat[:, None] != 0.0, up >= np.minimum(up_standing, 0.0) - 1e-12, keeps)

    inside = room < -NEAR
    holds = room_next >= np.minimum((1.0 - gamma) * np.maximum(room, 0.0) - NEAR, room_standing)
    fine = np.all(np.where(inside, keeps, holds), axis=0)
    return len(plan) if fine.all() else int(np.argmin(fine))


def _never_nearer(away: Array, motion: Array, standing: Array, dt: float) -> NDArray[np.bool_]:
    """(n, N) whether a step is at no instant nearer than both its start and standing still at that instant.

    With c = d.w and squares of speeds m = |w|^2, s = |w_0|^2 the squared distances grow by 2 c t + m t^2 in motion
    and by 2 c_0 t + s t^2 standing. Motion is nearer than the start for t < -2 c / m alone; there it must not be
    nearer than standing, and as their difference over t is linear in t, it is enough to look at both ends.

    Args:
        away: (n, N, 3) from obstacle to robot at the start of each step (m).
        motion: (n, N, 3) relative velocity in the step, w (m/s).
        standing: (n, N, 3) the same if the robot stood, w_0 (m/s).
        dt: length of a step (s).
    """
    closing, closing_standing = np.sum(away * motion, axis=2), np.sum(away * standing, axis=2)
    speed, speed_standing = np.sum(motion**2, axis=2), np.sum(standing**2, axis=2)
    nearer_for = np.clip(-2.0 * closing / np.maximum(speed, 1e-30), 0.0, dt)
    at_first = 2.0 * (closing - closing_standing)
    at_last = at_first + (speed - speed_standing) * nearer_for
    never: NDArray[np.bool_] = (closing >= -1e-12) | ((at_first >= -1e-12) & (at_last >= -1e-12))
    return never


def _starts_inside(problem: ControlProblem) -> bool:
    if rows.starts_clear(problem):
        return False
    away = problem.position - problem.centres
    room = rows.values(problem, away[:, None])[:, 0] - problem.sigmas
    return bool((room < -NEAR).any())
