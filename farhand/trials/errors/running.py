"""One run of one error, and what came of it."""

from collections import Counter
from functools import partial
from typing import ClassVar

import msgspec

from farhand.common.seeds import stream
from farhand.laboratory.campaigns.jobs import task_seed
from farhand.trials.errors.errors import ERRORS, Injected
from farhand.trials.errors.strikes import EVERY_NS, Strike
from farhand.trials.errors.world import STANDING, START_NS, World

NETWORKS = ("none", "constant:20", "gaussian:50,20", "uniform:20,120")
"""Beside the error; drawn by the seed."""
SECOND_NS = 1_000_000_000
LASTS_NS, AFTER_NS = 3_500_000_000, 3_500_000_000


class Spec(msgspec.Struct, frozen=True, kw_only=True):
    """One run: its name, which error, and the seed of all draws."""

    key: str
    name: str
    seed: int


class Row(msgspec.Struct, frozen=True, kw_only=True):
    """What came of it; the truth is measured at the robot, period by period.

    Attributes:
        key, name, seed: see Spec.
        standing: from the start of the error until the robot stood (s); None: it drove on.
        unexplained: periods with a motion that no lawful, fresh command explains.
        fastest_unexplained: of them (m/s).
        fastest: of the robot from the start of the error on (m/s).
        oldest: age of the oldest state that a command was built on which moved it (s).
        refused: by the robot from the start of the error on, by reason.
        refused_here: by the operator's side.
        mode: of the robot when the error ended.
        clearance: least distance to an obstacle (m); None: there is none.
        again: whether it moved by a lawful command after the error.
        duration: virtual time (s).
        error: what crashed.
    """

    UNITS: ClassVar[dict[str, str]] = {"standing": "s", "oldest": "s", "fastest": "m/s", "clearance": "m"}

    key: str
    name: str
    seed: int
    standing: float | None = None
    unexplained: int = 0
    fastest_unexplained: float = 0.0
    fastest: float = 0.0
    oldest: float = 0.0
    refused: dict[str, int] = {}
    refused_here: int = 0
    mode: str = ""
    clearance: float | None = None
    again: bool = False
    duration: float | None = None
    error: str = ""


def specs(names: tuple[str, ...], runs: int, seed: int) -> list[Spec]:
    """All runs, error by error."""
    return [
        Spec(key=f"{name}/{index}", name=name, seed=task_seed("errors", seed, name, index))
        for name in names
        for index in range(runs)
    ]


def lost(spec: Spec, error: str) -> Row:
    """The row of a run that has no result."""
    return Row(key=spec.key, name=spec.name, seed=spec.seed, error=" ".join(error.split()))


def run_all(chunk: list[Spec]) -> list[Row]:
    """A chunk, as sent to a worker; what raises becomes a row with `error`."""
    rows = []
    for spec in chunk:
        try:
            rows.append(run_one(spec))
        except Exception as error:
            rows.append(lost(spec, f"{type(error).__name__}: {error}"))
    return rows


def run_one(spec: Spec) -> Row:
    """Drive, inject for 3.5 s, and drive on for as long."""
    injected = ERRORS[spec.name]
    draw = stream(spec.seed, "errors", "network")
    network = NETWORKS[int(draw.integers(len(NETWORKS)))]
    world = World(spec.seed, network, injected.guarded)
    begin_ns = START_NS + int((2.0 + 2.0 * float(draw.random())) * SECOND_NS)
    end_ns = begin_ns + LASTS_NS
    world.run(begin_ns)
    if not world.lawful or not world.states:
        return lost(spec, "it had not begun to drive")
    before = Counter(world.robot.intake.refused())
    _inject(world, injected, begin_ns, end_ns, network)
    world.run(end_ns)
    report = world.operator.report
    mode = world.robot.watchdog.mode
    refused_here = report.refused_here if report is not None else 0
    world.run(end_ns + AFTER_NS)
    refused = Counter(world.robot.intake.refused())
    refused.subtract(before)
    clearance = world.robot.summary().min_clearance
    return Row(
        key=spec.key,
        name=spec.name,
        seed=spec.seed,
        standing=world.standing(begin_ns, end_ns + AFTER_NS // 2),
        unexplained=world.judge.unexplained,
        fastest_unexplained=world.judge.fastest,
        fastest=world.fastest(begin_ns, end_ns + AFTER_NS),
        oldest=world.judge.oldest_ns * 1e-9,
        refused={why: count for why, count in refused.items() if count},
        refused_here=refused_here,
        mode=mode,
        clearance=clearance if injected.guarded else None,
        again=world.fastest(end_ns + SECOND_NS, world.clock.now_ns()) > STANDING,
        duration=(end_ns + AFTER_NS - START_NS) * 1e-9,
    )


def _inject(world: World, injected: Injected, begin_ns: int, end_ns: int, network: str) -> None:
    for direction, spec in (("uplink", injected.up), ("downlink", injected.down)):
        if spec:
            beside = network if _beside(spec) and network != "none" else ""
            world.set_network(f"{beside} {spec}".strip(), begin_ns, direction)
            world.at(end_ns, partial(_restore, world, network, direction))
    if injected.holds is not None:
        world.before_robot = injected.holds(world)

        def give_back(now_ns: int) -> None:
            world.before_robot = None

        world.at(end_ns, give_back)
    if injected.strike is not None:
        _strike_again(world, injected.strike, begin_ns, end_ns)


def _restore(world: World, network: str, direction: str, now_ns: int) -> None:
    world.set_network(network, now_ns, direction)


def _beside(spec: str) -> bool:
    """Whether the error leaves the network's own delay as it is."""
    return not spec.startswith(("uniform", "constant"))


def _strike_again(world: World, strike: Strike, now_ns: int, end_ns: int) -> None:
    def due(now_ns: int) -> None:
        strike(world, now_ns)
        if now_ns + EVERY_NS < end_ns:
            world.at(now_ns + EVERY_NS, due)

    world.at(now_ns + EVERY_NS, due)
