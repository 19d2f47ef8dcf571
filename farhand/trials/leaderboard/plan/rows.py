"""One row a run: typed, in SI units."""

from typing import ClassVar

import msgspec

from farhand.trials.leaderboard.tasks.posing import Posed


class Spec(msgspec.Struct, frozen=True, kw_only=True):
    """One run, as it travels to a worker.

    Attributes:
        key: `network/scene/method/operator/index`, with a digest of a method's code and of a network's files where they
            are from outside.
        network, spec: its name and what it means, each direction.
        scene, method, operator: names.
        index: of the task.
        seed: of the run.
        task: what is to be done.
    """

    key: str
    network: str
    spec: str
    scene: str
    method: str
    operator: str
    index: int
    seed: int
    task: Posed


class Row(msgspec.Struct, frozen=True, kw_only=True):
    """What came of a run. Whatever is measured is measured on the robot, at its own rate, by exact shapes.

    Attributes:
        key, network, scene, method, operator, index, seed: see Spec.
        success: safe, and every target reached; of an operator without targets, safe.
        safe: no part of the robot ever nearer than d_min to anything: of an arm its links, else the sphere.
        finished: every target reached within the time limit.
        violations: times it was not.
        evadable: of them, those that the robot could have evaded; see evasion.py.
        run_over: of the others, those in which something ran into a robot that stood in a latched stop.
        violation_depth: how far beyond the limit (m).
        violation_seconds: for how long in all (s).
        min_clearance: smallest of the robot (m).
        min_tool_clearance: smallest of the sphere around the tool, which the operator's side keeps clear (m).
        duration: from the first motion command to the last target, or to the end (s).
        ideal_duration, ideal_path: of the ideal operator on the same task (s, m); see posing.ideal.
        path_length: way of the tool (m).
        filtered_share: share of the ticks in which the operator's side changed the wish.
        filtered_strength: by how much: sum of the changes over the sum of the wishes, as far as the limits allow them.
        guard_share: share of the time in which the guard on the robot acted.
        guard_strength: by how much it changed the speed, mean over the ticks that report it (m/s); None: never.
        stops: latched stops of the robot.
        infeasible: ticks in which the solver found no plan that meets every constraint.
        refused: commands that the robot refused.
        smoothness: spectral arc length of the tool's speed; see smoothness.py.
        rtt_mean: measured (s).
        digest: of every message that left or reached the operator, with its instant.
        why: what went wrong, in words.
        error: what crashed; then nothing else has a meaning.
    """

    UNITS: ClassVar[dict[str, str]] = {
        "violation_depth": "m",
        "violation_seconds": "s",
        "min_clearance": "m",
        "min_tool_clearance": "m",
        "duration": "s",
        "ideal_duration": "s",
        "path_length": "m",
        "ideal_path": "m",
        "guard_strength": "m/s",
        "rtt_mean": "s",
    }

    key: str
    network: str
    scene: str
    method: str
    operator: str
    index: int
    seed: int
    success: bool = False
    safe: bool = False
    finished: bool = False
    violations: int = 0
    evadable: int = 0
    run_over: int = 0
    violation_depth: float = 0.0
    violation_seconds: float = 0.0
    min_clearance: float | None = None
    min_tool_clearance: float | None = None
    duration: float | None = None
    ideal_duration: float | None = None
    path_length: float | None = None
    ideal_path: float | None = None
    filtered_share: float = 0.0
    filtered_strength: float = 0.0
    guard_share: float = 0.0
    guard_strength: float | None = None
    stops: int = 0
    infeasible: int = 0
    refused: int = 0
    smoothness: float | None = None
    rtt_mean: float | None = None
    digest: str = ""
    why: str = ""
    error: str = ""


def row_of(spec: Spec) -> Row:
    """The row of a run of which only that is known what it is; `msgspec.structs.replace` adds what came of it."""
    return Row(
        key=spec.key,
        network=spec.network,
        scene=spec.scene,
        method=spec.method,
        operator=spec.operator,
        index=spec.index,
        seed=spec.seed,
    )


def lost(spec: Spec, error: str) -> Row:
    """The row of a run that has no result."""
    return msgspec.structs.replace(row_of(spec), error=" ".join(error.split()))
