"""What is run: networks x scenes x methods x operators, each with the same tasks and the same draws of the network."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import count
from typing import Any

from farhand.laboratory.campaigns.jobs import task_seed
from farhand.laboratory.campaigns.store import source_digest
from farhand.programs.wiring import versions
from farhand.trials.leaderboard.methods.code import code_of
from farhand.trials.leaderboard.methods.method import METHODS
from farhand.trials.leaderboard.plan.networks import NETWORKS, content_of
from farhand.trials.leaderboard.plan.operators import OPERATORS
from farhand.trials.leaderboard.plan.rows import Row, Spec
from farhand.trials.leaderboard.tasks.posing import Posed, PoseJob
from farhand.trials.leaderboard.tasks.scenes import SCENES

ARM_SHARE = 5
"""An arm's cell has one task for so many of a sphere's."""
OPERATOR_SHARE = {"tester": 1}
OTHERS_SHARE = 4
"""The cells of other operators have one task for so many of the tester's."""


@dataclass(frozen=True)
class Board:
    """Attributes:
    tasks: in each cell of the sphere with the tester; see tasks_of.
    seed: of tasks, networks and operators.
    networks: SPEC by name.
    scenes, methods, operators: names.
    only: run this one task alone.
    before: commands that made rows in the same folder.
    made_by: of a board that shows all that is there, the commands that made it.
    """

    tasks: int = 20
    seed: int = 1
    networks: Mapping[str, str] = field(default_factory=lambda: dict(NETWORKS))
    scenes: tuple[str, ...] = tuple(SCENES)
    methods: tuple[str, ...] = METHODS.names()
    operators: tuple[str, ...] = tuple(OPERATORS)
    only: int | None = None
    before: tuple[str, ...] = ()
    made_by: tuple[str, ...] = ()

    def tasks_of(self, scene: str, operator: str) -> range:
        """Indices of a cell's tasks: fewer of an arm, which takes longer, and of operators other than the tester."""
        if self.only is not None:
            return range(self.only, self.only + 1)
        return range(_so_many(self.tasks, _share(scene, operator)))

    def about(self) -> dict[str, Any]:
        """What makes the rows; the selection says which, and may grow later in the same folder."""
        return {
            "campaign": "benchmark safety",
            "seed": self.seed,
            "selection": {
                "tasks": self.tasks if self.only is None else [self.only],
                "networks": dict(self.networks),
                "scenes": list(self.scenes),
                "methods": list(self.methods),
                "operators": list(self.operators),
                "commands": list(self.commands()),
            },
            "versions": versions() | {"source": source_digest("trials/leaderboard/telling")},
        }

    def commands(self) -> tuple[str, ...]:
        """All that made the rows of the folder, this board's last."""
        return self.made_by or (*(each for each in self.before if each != self.command()), self.command())

    def showing(self, rows: Sequence[Row]) -> "Board":
        """The board of all rows that are there: beside its own those that other commands have put into the folder."""

        def also(own: Sequence[str], known: Sequence[str], found: Iterable[str]) -> tuple[str, ...]:
            there = {*own, *found}
            return (*(name for name in known if name in there), *sorted(there - set(known)))

        networks = also(tuple(self.networks), tuple(NETWORKS), (row.network for row in rows))
        indices = {row.index for row in rows}
        alone = self.only if indices == {self.only} else None
        return replace(
            self,
            tasks=self.tasks if alone is not None else max(map(self._tasks_for, rows), default=self.tasks),
            networks={name: NETWORKS.get(name, name) for name in networks},
            scenes=also(self.scenes, tuple(SCENES), (row.scene for row in rows)),
            methods=also(self.methods, METHODS.names(), (row.method for row in rows)),
            operators=also(self.operators, tuple(OPERATORS), (row.operator for row in rows)),
            only=alone,
            made_by=self.commands(),
        )

    def sorted_rows(self, rows: Iterable[Row]) -> list[Row]:
        """Rows in the board's order: of names in the order of the page."""
        names = (self.operators, self.scenes, tuple(self.networks), self.methods)
        places = [{name: place for place, name in enumerate(each)} for each in names]

        def place(row: Row) -> tuple[int, ...]:
            own = (row.operator, row.scene, row.network, row.method)
            return (*(known[name] for known, name in zip(places, own, strict=True)), row.index)

        return sorted(rows, key=place)

    def _tasks_for(self, row: Row) -> int:
        """The least number of tasks with which a board has this row."""
        share = _share(row.scene, row.operator)
        return next(tasks for tasks in count(1) if _so_many(tasks, share) > row.index)

    def command(self) -> str:
        """The command that makes this board."""
        parts = [
            "farhand benchmark safety",
            f"--tasks {self.tasks}" if self.only is None else f"--task {self.only}",
        ]
        if tuple(self.networks) != tuple(NETWORKS):
            plain = [name for name in self.networks if name in NETWORKS]
            parts += [f"--networks {','.join(plain)}"] if plain else []
            parts += [f'--networks "{name}"' for name in self.networks if name not in NETWORKS]
        for option, names, known in (
            ("--scenes", self.scenes, tuple(SCENES)),
            ("--methods", self.methods, METHODS.names()),
            ("--operators", self.operators, tuple(OPERATORS)),
        ):
            parts += [f"{option} {','.join(names)}"] if names != known else []
        return " ".join([*parts, f"--seed {self.seed}"])

    def pose_jobs(self) -> list[PoseJob]:
        """One a task, in the order in which they are needed."""
        found = [
            (self._place(scene, operator, index), scene, index)
            for scene in self.scenes
            for operator in self.operators
            for index in self.tasks_of(scene, operator)
        ]
        found.sort(key=lambda each: each[0])
        names = dict.fromkeys((scene, index) for _, scene, index in found)
        return [
            PoseJob(key=f"{scene}/{index}", scene=scene, index=index, seed=self.seed)
            for scene, index in names
        ]

    def specs(self, posed: Sequence[Posed]) -> list[Spec]:
        """One a run. A stopped table is whole, with fewer tasks: all cells advance together."""
        tasks = {(task.scene, task.index): task for task in posed if not task.error}
        over, by = self.versions()
        found = [
            (self._place(scene, operator, index), scene, operator, index)
            for scene in self.scenes
            for operator in self.operators
            for index in self.tasks_of(scene, operator)
            if (scene, index) in tasks
        ]
        found.sort(key=lambda each: each[0])
        return [
            self._spec((network, over[network]), tasks[scene, index], (method, by[method]), operator)
            for _, scene, operator, index in found
            for network in self.networks
            for method in self.methods
        ]

    def versions(self) -> tuple[dict[str, str], dict[str, str]]:
        """What keys call its networks and methods: with the digest of their files, where they have any of their own."""
        over = {name: _version(name, content_of(name, spec)) for name, spec in self.networks.items()}
        return over, {method: _version(method, code_of(method)) for method in self.methods}

    def _place(self, scene: str, operator: str, index: int) -> float:
        """Where in the campaign a task comes, 0 to 1."""
        return (index + 0.5) / len(self.tasks_of(scene, operator)) if self.only is None else 0.0

    def _spec(self, network: tuple[str, str], task: Posed, method: tuple[str, str], operator: str) -> Spec:
        """Of a network and a method, each with its version."""
        return Spec(
            key=f"{network[1]}/{task.scene}/{method[1]}/{operator}/{task.index}",
            network=network[0],
            spec=self.networks[network[0]],
            scene=task.scene,
            method=method[0],
            operator=operator,
            index=task.index,
            seed=task_seed("leaderboard", self.seed, task.scene, task.index),
            task=task,
        )


def versions_in(key: str) -> tuple[str, str]:
    """What a row's key calls its network and its method."""
    over, _, by, _, _ = key.rsplit("/", 4)
    return over, by


def _version(name: str, digest: str) -> str:
    return f"{name}@{digest}" if digest else name


def _share(scene: str, operator: str) -> int:
    """A cell has one task for so many of the sphere's with the tester."""
    return OPERATOR_SHARE.get(operator, OTHERS_SHARE) * (ARM_SHARE if SCENES[scene].robot == "arm" else 1)


def _so_many(tasks: int, share: int) -> int:
    return max(1, round(tasks / share))


def command_of(row: Row, seed: int) -> str:
    """The command that repeats a row; `seed` is the board's."""
    plain = row.network.replace("-", "").replace(".", "").isalnum()
    network = row.network if plain else f'"{row.network}"'
    return (
        f"farhand benchmark safety --networks {network} --scenes {row.scene} --methods {row.method} "
        f"--operators {row.operator} --task {row.index} --seed {seed}"
    )
