"""Every margin law on every network: drives in virtual time, each command held against what became of it."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass

import msgspec

from farhand.laboratory.campaigns.pools import Pool
from farhand.laboratory.coverage.measures import Coverage, coverage_of
from farhand.laboratory.coverage.observer import Chosen, Observer
from farhand.laboratory.simulation import simulate_run
from farhand.operator_side.margins.registry import make_margin
from farhand.operator_side.pace import pace_of
from farhand.operator_side.prediction.registry import PREDICTORS
from farhand.runs.run import Run
from farhand.runs.scenario import Scenario, load_scenario, replace_settings

SCENARIO = "point-obstacle"
LEG_TIME = 2.0
"""A leg takes longer than this, so that there are targets enough (s)."""
ALL = "all"


@dataclass(frozen=True, slots=True)
class Drive:
    """One law over one network.

    Attributes:
        network: how it is called in the table.
        spec: SPEC of both directions.
        law: of the margin.
        seconds: how long it is driven (s).
        seed: of the network's draws.
    """

    network: str
    spec: str
    law: str
    seconds: float
    seed: int = 0


class CoverageRow(msgspec.Struct, frozen=True, kw_only=True):
    """Attributes:
    network: how it is called; `all`: of all networks together.
    law: of the margin.
    predictor: that was in force with it.
    coverage: see Coverage.
    """

    network: str
    law: str
    predictor: str
    coverage: Coverage


def back_and_forth(law: str, seconds: float) -> Scenario:
    """The point robot's scenario under a law, its targets again and again for so long (s); raises ScenarioError."""
    own = load_scenario(SCENARIO)
    times = max(1, round(seconds / LEG_TIME / len(own.targets)))
    changed = replace_settings(own, {"margin.kind": law, "guard.on": False})
    return msgspec.structs.replace(changed, targets=changed.targets * times)


def drive(job: Drive) -> tuple[Drive, str, list[Chosen]]:
    """Drive once; the predictor's name, and every command that left meanwhile."""
    run = _run_of(job)
    scenario = run.scenario
    law = make_margin(scenario.margin)
    predictor = scenario.predictor
    observer = Observer(
        robot=scenario.robot.kind,
        lag=scenario.robot.lag,
        law=law,
        compensates=PREDICTORS.get(predictor).compensates_lag,
        period=pace_of(scenario).tick,
    )
    simulate_run(run, listener=observer.heard, tap=observer)
    return job, predictor, list(observer.commands.values())


def measure(
    drives: Sequence[Drive], pool: Pool | None, progress: Callable[[int], None] = lambda done: None
) -> list[CoverageRow]:
    """Drive all of them; rows in their order, and one of all networks together for each law, where there are several.

    Args:
        drives: what to do.
        pool: where; None: one after the other, in this process.
        progress: told how many are done.

    Raises InputError for a network that makes no sense, before anything is driven, and what a drive raises.
    """
    for each in drives:
        _run_of(each)
    done: dict[Drive, tuple[str, list[Chosen]]] = {}
    for job, predictor, commands in _driven(drives, pool):
        done[job] = (predictor, commands)
        progress(len(done))
    return list(_rows(drives, done))


def _driven(drives: Sequence[Drive], pool: Pool | None) -> Iterator[tuple[Drive, str, list[Chosen]]]:
    if pool is None:
        yield from map(drive, drives)
        return
    with pool.open(min(pool.width, len(drives))) as executor:
        for future in as_completed([executor.submit(drive, each) for each in drives]):
            yield future.result()


def _run_of(job: Drive) -> Run:
    run = Run.over(back_and_forth(job.law, job.seconds), job.spec, seed=job.seed)
    return msgspec.structs.replace(run, time_limit=job.seconds)


def _rows(drives: Sequence[Drive], done: dict[Drive, tuple[str, list[Chosen]]]) -> Iterator[CoverageRow]:
    for each in drives:
        predictor, commands = done[each]
        yield CoverageRow(
            network=each.network, law=each.law, predictor=predictor, coverage=coverage_of(commands)
        )
    if len({each.network for each in drives}) < 2:
        return
    for law in dict.fromkeys(each.law for each in drives):
        mine = [done[each] for each in drives if each.law == law]
        together = coverage_of([command for _, commands in mine for command in commands])
        yield CoverageRow(network=ALL, law=law, predictor=mine[0][0], coverage=together)
