"""Problems for the proof and the speed of the solvers: random ones, and ticks of closed loops."""

from collections.abc import Iterator

import numpy as np

from farhand.common.seeds import stream
from farhand.operator_side.control.controller import ControlProblem, ControlSolution
from farhand.operator_side.control.registry import make_controller
from farhand.operator_side.control.settings import ControllerSettings

COUNTS = (0, 1, 2, 3, 5, 10, 20, 50, 100)
SETTINGS = ControllerSettings()


def random_problem(rng: np.random.Generator, count: int) -> ControlProblem:
    """From outside every obstacle: any direction, up to 1.2 times the limits, near obstacles, some moving."""
    away = rng.normal(size=(count, 3))
    away /= np.linalg.norm(away, axis=1, keepdims=True) if count else 1.0
    radii = rng.uniform(0.07, 0.4, count)
    # the more obstacles, the farther out: else there is nowhere to go
    gaps = 0.02 + rng.exponential(0.15 + 0.02 * count, count)
    heading = rng.normal(size=3)
    heading /= np.linalg.norm(heading)
    moving = rng.random() < 0.3
    position = rng.uniform(-1.0, 1.0, 3)
    return ControlProblem(
        position=position,
        desired=heading * rng.uniform(0.02, 1.2 * SETTINGS.speed_limit[0]),
        centres=position + away * (radii + gaps)[:, None],
        radii=radii,
        velocities=rng.uniform(-0.1, 0.1, (count, 3)) if moving else np.zeros((count, 3)),
        sigmas=np.full(count, rng.choice([0.0, 0.001, 0.004])),
    )


def random_problems(number: int, seed: int = 1) -> Iterator[ControlProblem]:
    """As many problems, with 0 to 100 obstacles."""
    rng = stream(seed, "solver", "random")
    for index in range(number):
        yield random_problem(rng, COUNTS[index % len(COUNTS)])


def closed_loop(
    number: int, seed: int = 1, counts: tuple[int, ...] = COUNTS, settings: ControllerSettings = SETTINGS
) -> Iterator[tuple[ControlProblem, ControlSolution]]:
    """Ticks of drives through random fields towards random targets, with the compiled solver's answer to
    each.

    A drive starts outside every obstacle and ends at its target or after 150 ticks.
    """
    rng = stream(seed, "solver", "closed-loop")
    given = 0
    drive = 0
    while True:
        count = counts[drive % len(counts)]
        drive += 1
        controller = make_controller(settings)
        position = np.zeros(3)
        # at a density of about one in 0.12 m^3: passages exist, but seldom a straight one
        half = max(0.4, 0.25 * count ** (1 / 3))
        target = rng.uniform(-1.0, 1.0, 3)
        target *= max(0.8, 0.9 * half) / np.linalg.norm(target)
        centres = rng.uniform(-half, half, (count, 3)) + 0.5 * target
        radii = rng.uniform(0.07, 0.2, count)
        for free in (position, target):
            near = np.linalg.norm(centres - free, axis=1) < radii + 0.03
            centres, radii = centres[~near], radii[~near]
        for _ in range(150):
            away = target - position
            distance = float(np.linalg.norm(away))
            if distance < 0.02:
                break
            speed = float(np.interp(distance, [0.15, 0.5], [0.05, 0.5]))
            problem = ControlProblem(
                position.copy(),
                np.clip(speed * away / distance, -0.3, 0.3),
                centres,
                radii,
                np.zeros_like(centres),
                np.full(len(radii), 0.002),
            )
            solution = controller.solve(problem)
            yield problem, solution
            given += 1
            if given == number:
                return
            position = position + settings.period * solution.plan[0]
