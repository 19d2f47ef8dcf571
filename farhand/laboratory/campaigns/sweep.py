"""Sweeps: any setting of a scenario or a network over a grid and seeds, from one TOML file."""

import itertools
from pathlib import Path
from typing import Annotated, Any

import msgspec
from msgspec import Meta, Struct

from farhand.common.errors import InputError, SpecError
from farhand.common.scenario.reader import name_key
from farhand.common.toml import read_toml
from farhand.laboratory.campaigns.jobs import Job
from farhand.laboratory.campaigns.store import source_digest
from farhand.laboratory.campaigns.tasks import make_task
from farhand.programs.wiring import versions
from farhand.runs.run import Network, NetworkChoice, Run, choose_network, read_choice
from farhand.runs.scenario import Scenario, load_scenario, replace_setting, scenario_to_table

RANDOM_TASKS = "random-tasks"
"""In place of a scenario: each seed is a random task of its own, as in Table I."""
MAX_RUNS = 1_000_000
NETWORK = ("network", "uplink", "downlink")

Seed = Annotated[int, Meta(ge=0, le=2**53)]


class SweepFile(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The file.

    Attributes:
        name: of the sweep.
        scenario: built-in name, TOML file relative to this one, or `random-tasks`.
        network: SPEC of both directions; `{word}` stands for the grid's values of `word`. Without it, the
            scenario's own, else `none`.
        uplink, downlink: where they differ.
        seeds: how many, from 0 on, or which.
        time_limit: of a run, from the first motion (s).
        computing_time: of a control tick (ms).
        grid: values by setting (`controller.gamma`), by `network`, `uplink`, `downlink`, or by word.
    """

    name: Annotated[str, Meta(min_length=1, max_length=64)] = "sweep"
    scenario: str
    network: str | None = None
    uplink: str | None = None
    downlink: str | None = None
    seeds: Annotated[int, Meta(ge=1, le=MAX_RUNS)] | Annotated[tuple[Seed, ...], Meta(min_length=1)] = 1
    time_limit: Annotated[float, Meta(gt=0, le=1e5)] = 300.0
    computing_time: Annotated[float, Meta(ge=0, le=10_000)] = 20.0
    grid: dict[str, list[Any]]

    def seed_values(self) -> tuple[int, ...]:
        """Which seeds."""
        return tuple(range(self.seeds)) if isinstance(self.seeds, int) else self.seeds


class Sweep:
    """A sweep that has been read and checked.

    Args:
        path: the TOML file.

    Raises:
        InputError: one clear line.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.file = _read(path)
        self._base = None if self.file.scenario == RANDOM_TASKS else _load(path, self.file.scenario)
        self._check_grid()
        self.jobs = self._jobs()

    def about(self) -> dict[str, Any]:
        """What makes the rows."""
        file: dict[str, Any] = msgspec.to_builtins(self.file)
        selection = {key: file.pop(key) for key in ("grid", "seeds")}
        base = None if self._base is None else scenario_to_table(self._base)
        return {
            "campaign": "sweep",
            "selection": selection,
            "file": file,
            "scenario": base,
            "versions": versions() | {"source": source_digest()},
        }

    def _check_grid(self) -> None:
        grid = self.file.grid
        if not grid:
            raise InputError(
                f'sweep {self.path}: grid: is empty; expected e.g. "controller.gamma" = [0.3, 0.5]'
            )
        runs = len(self.file.seed_values())
        for key, values in grid.items():
            if not key.isprintable():
                raise InputError(f"sweep {self.path}: grid: {key!r}: is the name of no setting")
            if not values:
                raise InputError(f"sweep {self.path}: grid.{key}: has no values")
            if len({repr(value) for value in values}) != len(values):
                raise InputError(f"sweep {self.path}: grid.{key}: a value is there twice")
            runs *= len(values)
        if len(set(self.file.seed_values())) != len(self.file.seed_values()):
            raise InputError(f"sweep {self.path}: seeds: a seed is there twice")
        if runs > MAX_RUNS:
            raise InputError(f"sweep {self.path}: asks for {runs} runs; at most {MAX_RUNS} are possible")

    def _jobs(self) -> list[Job]:
        grid = self.file.grid
        jobs = []
        for values in itertools.product(*grid.values()):
            labels = dict(zip(grid, values, strict=True))
            jobs += self._point(labels)
        return jobs

    def _point(self, labels: dict[str, Any]) -> list[Job]:
        """The jobs of one point of the grid, one a seed."""
        choice, used = self._choice(labels)
        base = self._apply(self._base, labels, used) if self._base is not None else None
        network = self._network(base, choice) if base is not None else None
        name = "/".join(f"{key}={value}" for key, value in labels.items())
        jobs = []
        for seed in self.file.seed_values():
            scenario = base if base is not None else self._apply(make_task(0, seed), labels, used)
            run = Run(
                scenario=scenario,
                network=network if network is not None else self._network(scenario, choice),
                seed=seed,
                time_limit=self.file.time_limit,
                computing_time=(self.file.computing_time * 1e-3,),
            )
            jobs.append(Job(key=f"{name}/{seed}", labels=labels, run=run))
        return jobs

    def _apply(self, scenario: Scenario, labels: dict[str, Any], used: set[str]) -> Scenario:
        for key, value in labels.items():
            if key in used:
                continue
            try:
                scenario = replace_setting(scenario, key, value)
            except InputError as error:
                raise InputError(f"sweep {self.path}: grid.{key} = {value!r}: {error}") from None
        return scenario

    def _choice(self, labels: dict[str, Any]) -> tuple[NetworkChoice, set[str]]:
        """What a point says of the network, and the labels that went into it."""
        used = {key for key in NETWORK if key in labels}
        specs: dict[str, str] = {}
        for name in NETWORK:
            spec = labels.get(name, getattr(self.file, name))
            if spec is not None:
                specs[name] = str(spec)
        if "uplink" in specs and "downlink" in specs:
            specs.pop("network", None)  # of no account, as are the words in it
        for name, spec in specs.items():
            for key, value in labels.items():
                if "{" + key + "}" in spec:
                    spec = spec.replace("{" + key + "}", str(value))
                    used.add(key)
            specs[name] = spec
        try:
            return read_choice(**specs), used
        except SpecError as error:
            raise InputError(f"sweep {self.path}: {error}") from None

    def _network(self, scenario: Scenario, choice: NetworkChoice) -> Network:
        try:
            return choose_network(scenario, choice, where=self.file.scenario)
        except SpecError as error:
            raise InputError(f"sweep {self.path}: {error}") from None


def _read(path: Path) -> SweepFile:
    try:
        return msgspec.convert(read_toml(path, "sweep"), SweepFile)
    except msgspec.ValidationError as error:
        raise InputError(f"sweep {path}: {name_key(str(error))}") from None


def _load(path: Path, name: str) -> Scenario:
    """A built-in scenario, or a file beside the sweep's."""
    beside = path.parent / name
    return load_scenario(str(beside) if name.endswith(".toml") and beside.exists() else name)
