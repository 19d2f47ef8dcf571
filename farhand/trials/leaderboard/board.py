"""What is run: networks x scenes x methods x operators, each with the same tasks and the same draws of the network."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from farhand.laboratory.campaigns.jobs import task_seed
from farhand.laboratory.campaigns.store import source_digest
from farhand.programs.wiring import versions
from farhand.trials.leaderboard.method import METHODS, code_of
from farhand.trials.leaderboard.networks import NETWORKS
from farhand.trials.leaderboard.operators import OPERATORS
from farhand.trials.leaderboard.posing import Posed, PoseJob
from farhand.trials.leaderboard.rows import Row, Spec
from farhand.trials.leaderboard.scenes import SCENES

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
    """

    tasks: int = 20
    seed: int = 1
    networks: Mapping[str, str] = field(default_factory=lambda: dict(NETWORKS))
    scenes: tuple[str, ...] = tuple(SCENES)
    methods: tuple[str, ...] = METHODS.names()
    operators: tuple[str, ...] = tuple(OPERATORS)
    only: int | None = None

    def tasks_of(self, scene: str, operator: str) -> range:
        """Indices of a cell's tasks: fewer of an arm, which takes longer, and of operators other than the tester."""
        if self.only is not None:
            return range(self.only, self.only + 1)
        share = OPERATOR_SHARE.get(operator, OTHERS_SHARE) * (
            ARM_SHARE if SCENES[scene].robot == "arm" else 1
        )
        return range(max(1, round(self.tasks / share)))

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
            },
            "versions": versions() | {"source": source_digest("trials/leaderboard", "trials/safety")},
        }

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
        codes = {method: code_of(method) for method in self.methods}
        found = [
            (self._place(scene, operator, index), scene, operator, index)
            for scene in self.scenes
            for operator in self.operators
            for index in self.tasks_of(scene, operator)
            if (scene, index) in tasks
        ]
        found.sort(key=lambda each: each[0])
        return [
            self._spec(network, tasks[scene, index], method, codes[method], operator)
            for _, scene, operator, index in found
            for network in self.networks
            for method in self.methods
        ]

    def _place(self, scene: str, operator: str, index: int) -> float:
        """Where in the campaign a task comes, 0 to 1."""
        return (index + 0.5) / len(self.tasks_of(scene, operator)) if self.only is None else 0.0

    def _spec(self, network: str, task: Posed, method: str, code: str, operator: str) -> Spec:
        named = f"{method}@{code}" if code else method
        return Spec(
            key=f"{network}/{task.scene}/{named}/{operator}/{task.index}",
            network=network,
            spec=self.networks[network],
            scene=task.scene,
            method=method,
            operator=operator,
            index=task.index,
            seed=task_seed("leaderboard", self.seed, task.scene, task.index),
            task=task,
        )


def command_of(row: Row, seed: int) -> str:
    """The command that repeats a row; `seed` is the board's."""
    plain = row.network.replace("-", "").replace(".", "").isalnum()
    network = row.network if plain else f'"{row.network}"'
    return (
        f"farhand benchmark safety --networks {network} --scenes {row.scene} --methods {row.method} "
        f"--operators {row.operator} --task {row.index} --seed {seed}"
    )
