"""From a desired velocity to a safe plan: margin and obstacles into the controller, its answer checked."""

from dataclasses import replace

import msgspec
import numpy as np

from farhand.common.geometry import Array, norm
from farhand.common.messages.base import Vector3
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.operator_side.control.barrier import subset
from farhand.operator_side.control.checks.body import clear_steps
from farhand.operator_side.control.checks.fallback import safe_plan
from farhand.operator_side.control.checks.recovery import eased
from farhand.operator_side.control.controller import Controller, ControlProblem, ControlSolution, zero_plan
from farhand.operator_side.control.settings import ControllerSettings
from farhand.operator_side.margins.law import Margin
from farhand.operator_side.margins.trail import Trail
from farhand.operator_side.prediction.law import Prediction
from farhand.operator_side.sensing.seen_obstacles import SeenObstacles


class Filtered(msgspec.Struct, frozen=True):
    """Attributes:
    plan: (N, 3) to be sent (m/s).
    solution: the controller's answer.
    binding: id of the obstacle that binds, or empty.
    reason: why `plan` is not the controller's, or empty.
    lag_part: what the lag added to the nearest obstacle's radius (m).
    """

    plan: Array
    solution: ControlSolution
    binding: str
    reason: str
    lag_part: float = 0.0


class Ahead(msgspec.Struct, frozen=True):
    """What a plan is to be found for.

    Attributes:
        desired: velocity that is wanted (m/s).
        prediction: where the plan begins.
        margin: how much more than d_min to keep.
        state, scene: newest from the robot.
    """

    desired: Vector3
    prediction: Prediction
    margin: Margin
    state: RobotState
    scene: Scene


class SafetyFilter:
    """Poses the controller's problem from the scene that came over the wire.

    Args:
        settings: of the controller.
        controller: the controller.
        robot: what it is.
        trails: whether predictions are of z = x + lag v, behind which the body trails.
        tick: from one command to the next (s); None: a step of the plan.
    """

    def __init__(
        self,
        settings: ControllerSettings,
        controller: Controller,
        robot: RobotDescription,
        trails: bool,
        tick: float | None = None,
    ) -> None:
        self._settings = settings
        self._tick = settings.period if tick is None else tick
        self._lag = robot.lag
        self._bare = settings.kind == "pass-through"
        pays = trails and robot.lag > 0.0 and not self._bare
        self._trail = Trail(settings.speed_limit, robot.lag, self._tick) if pays else None
        self._keep = robot.radius + settings.d_min
        self._controller = controller
        self._obstacles: SeenObstacles | None = None
        self._posed: ControlProblem | None = None

    def filter(self, ahead: Ahead) -> Filtered:
        """The plan for a desired velocity.

        Obstacles are taken to where they will be when the command takes effect: both stamps are the robot's,
        so no two clocks are compared.
        """
        prediction, margin, scene = ahead.prediction, ahead.margin, ahead.scene
        obstacles = self._seen(scene)
        old = (ahead.state.t_sample_ns - scene.t_sample_ns) * 1e-9
        seen = obstacles.at(old + prediction.look + self._lag)
        position = np.array(prediction.start)
        radii = seen.radii + margin.inflation
        # A body that follows a bend cuts no plane: z above it is what the body heads for.
        spheres = obstacles.spheres
        desired, kept, trail = np.array(ahead.desired), radii, self._trail if spheres else None
        if trail is not None:
            planes = spheres < len(radii)
            body = radii[:spheres] if planes else radii
            away = position - seen.centres[:spheres]
            gaps = np.sqrt(np.add.reduce(away * away, axis=1))
            speeds = seen.speeds[:spheres]
            desired = trail.desired(desired, body, gaps, speeds)
            grown = trail.radii(body, desired, norm(ahead.state.velocity), speeds)
            kept = np.concatenate([grown, radii[spheres:]]) if planes else grown
        problem = ControlProblem(
            position=position,
            desired=desired,
            centres=seen.centres,
            radii=kept,
            velocities=seen.velocities,
            sigmas=np.full(len(radii), margin.sigma),
            normals=obstacles.normals,
        )
        self._posed = problem
        # A margin may have grown over the robot: then the way out is solved for, and checked as strictly.
        solution = self._controller.solve(self._wayout(problem) or problem)
        plan, reason = safe_plan(problem, solution, self._settings)
        binding = obstacles.ids[solution.binding] if solution.binding >= 0 else ""
        lag_part = 0.0
        if trail is not None:
            balls = subset(problem, np.arange(spheres)) if planes else problem
            plan, reason = self._kept_from_corners(balls, body, plan, reason, ahead)
            parts = grown - body
            lag_part = float(parts[np.argmin(gaps - body)])
            trail.learn(desired, plan[0], float(parts.max()))
        return Filtered(plan, solution, binding, reason, lag_part)

    def problem_from(self, start: Vector3) -> ControlProblem | None:
        """The newest problem a tick later, from `start` (m), for those who only look; None before the first."""
        posed = self._posed
        if posed is None:
            return None
        moved = posed.centres + self._tick * posed.velocities
        return replace(posed, position=np.array(start), centres=moved)

    def name_of(self, row: int) -> str:
        """The obstacle that a row of the newest problem stands for; empty for -1."""
        return self._obstacles.ids[row] if self._obstacles is not None and row >= 0 else ""

    def stand_still(self) -> Array:
        """A plan of zeros; the warm start is forgotten."""
        self._controller.reset()
        return zero_plan(self._settings)

    def _wayout(self, problem: ControlProblem) -> ControlProblem | None:
        """What is solved inside a margin; None outside, and for who takes what is asked for as it is."""
        return None if self._bare else eased(problem, self._settings)

    def _kept_from_corners(
        self, problem: ControlProblem, radii: Array, plan: Array, reason: str, ahead: Ahead
    ) -> tuple[Array, str]:
        """The plan as far as the body that trails behind it stays clear, and why it is not all of it."""
        velocity = ahead.prediction.velocity or ahead.state.velocity
        motion = (np.array(velocity), self._lag, self._settings.period)
        steps = clear_steps(problem, radii, plan, motion)
        if steps == len(plan):
            return plan, reason
        plan = plan.copy()
        plan[steps:] = 0.0
        what = "stopped" if steps == 0 else f"plan cut after {steps} steps"
        return plan, reason or f"the body trails through a margin: {what}"

    def _seen(self, scene: Scene) -> SeenObstacles:
        """Rows of a scene, made once."""
        if self._obstacles is None or self._obstacles.scene is not scene:
            self._obstacles = SeenObstacles(scene, self._keep, self._settings)
        return self._obstacles
