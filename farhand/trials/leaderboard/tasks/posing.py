"""Which tasks there are: drawn from a seed until one needs care, and a perfect operator of ours, without any delay, can
do it."""

from typing import Any, ClassVar

import msgspec

from farhand.common.errors import ScenarioError
from farhand.common.seeds import stream
from farhand.laboratory.simulation import SimulationResult
from farhand.runs.run import Run
from farhand.runs.scenario import Scenario, replace_settings, scenario_to_table
from farhand.trials.leaderboard.judge.witness import Seen, watched
from farhand.trials.leaderboard.methods.method import applied, method_named
from farhand.trials.leaderboard.tasks.scenes import SCENES

MOST_DRAWS = 500
IDEAL_LIMIT = 60.0
"""Of a task for the ideal operator (s)."""
IDEALS = ("guard", "both")


class PoseJob(msgspec.Struct, frozen=True, kw_only=True):
    """Attributes:
    key: `scene/index`.
    scene, index: which task.
    seed: of the campaign.
    """

    key: str
    scene: str
    index: int
    seed: int


class Posed(msgspec.Struct, frozen=True, kw_only=True):
    """A task.

    Attributes:
        unfit: draws that were thrown away as they did not hold what the scene promises, or nothing was in the way.
        undoable: draws that were thrown away as the ideal operator could not do them.
        duration, path_length: of the ideal operator (s, m); see `ideal`.
        scenario: as nested dictionaries.
        error: what crashed.
    """

    UNITS: ClassVar[dict[str, str]] = {"duration": "s", "path_length": "m"}

    key: str
    scene: str
    index: int
    seed: int
    unfit: int = 0
    undoable: int = 0
    duration: float | None = None
    path_length: float | None = None
    scenario: dict[str, Any] = msgspec.field(default_factory=dict)
    error: str = ""


def pose_all(jobs: list[PoseJob]) -> list[Posed]:
    """A chunk of jobs, as sent to a worker."""
    return [pose(job) for job in jobs]


def lost(job: PoseJob, error: str) -> Posed:
    """The row of a job that has no result."""
    return Posed(key=job.key, scene=job.scene, index=job.index, seed=job.seed, error=" ".join(error.split()))


def pose(job: PoseJob) -> Posed:
    """Draw until one can be done; what raises becomes a row with `error`."""
    try:
        return _pose(job)
    except Exception as error:
        return lost(job, f"{type(error).__name__}: {error}")


def _pose(job: PoseJob) -> Posed:
    unfit = undoable = 0
    scene = SCENES[job.scene]
    for attempt in range(MOST_DRAWS):
        rng = stream(job.seed, "leaderboard", job.scene, str(job.index), str(attempt))
        try:
            scenario = scene.draw(rng)
            if scenario is not None and not needs_care(scenario, job.index):
                scenario = None
            done = None if scenario is None else ideal(scenario, job.index)
        except ScenarioError:  # out of the arm's reach, or in the way of its start
            scenario = done = None
        if scenario is None:
            unfit += 1
        elif done is None:
            undoable += 1
        else:
            table = scenario_to_table(scenario)
            return Posed(
                key=job.key,
                scene=job.scene,
                index=job.index,
                seed=job.seed,
                unfit=unfit,
                undoable=undoable,
                duration=done[0],
                path_length=done[1],
                scenario=table,
            )
    return lost(job, f"none of {MOST_DRAWS} draws could be done")


def needs_care(scenario: Scenario, seed: int) -> bool:
    """Whether a robot that does what the tester asks for, without any delay, comes too near to something."""
    return _undelayed(scenario, "nothing", seed, sidestep=False)[1].body.count > 0


def ideal(scenario: Scenario, seed: int) -> tuple[float, float] | None:
    """Duration (s) and path (m) of the ideal operator, who has no delay and no computing time.

    It is the tester with side-steps, or without them where it is quicker so, with the guard alone or with both layers.
    None where it is not brought safely through with side-steps.
    """
    found = _finished(scenario, seed, sidestep=True)
    return min([*found, *_finished(scenario, seed, sidestep=False)]) if found else None


def _finished(scenario: Scenario, seed: int, *, sidestep: bool) -> list[tuple[float, float]]:
    found = []
    for name in IDEALS:
        result, seen = _undelayed(scenario, name, seed, sidestep=sidestep)
        if result.summary.finished and not seen.body.count:
            found.append((result.summary.duration, result.summary.path_length))
    return found


def _undelayed(
    scenario: Scenario, method: str, seed: int, *, sidestep: bool
) -> tuple[SimulationResult, Seen]:
    posed = replace_settings(
        applied(method_named(method), scenario), {"steering.tester": {"sidestep": sidestep}}
    )
    run = msgspec.structs.replace(
        Run.over(posed, "none", seed=seed), time_limit=IDEAL_LIMIT, computing_time=(0.0,)
    )
    return watched(run, gives_up=True)
