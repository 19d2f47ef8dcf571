"""What the command line asks for: which board; raises InputError in one line."""

from collections.abc import Callable

from farhand.common.errors import InputError
from farhand.common.kinds import made
from farhand.runs.scenario import load_scenario
from farhand.trials.leaderboard.methods.method import METHODS, applied, method_named
from farhand.trials.leaderboard.plan.board import Board
from farhand.trials.leaderboard.plan.networks import NETWORKS, networks_named
from farhand.trials.leaderboard.plan.operators import OPERATORS
from farhand.trials.leaderboard.tasks.scenes import SCENES

TASKS = 20
QUICK_TASKS = 2
QUICK_NETWORKS = ("constant", "outages-2s")


def chosen_board(  # noqa: PLR0913 (an option each)
    *,
    quick: bool = False,
    tasks: int | None = None,
    networks: list[str] | None = None,
    scenes: str = "",
    methods: str = "",
    operators: str = "",
    seed: int = 1,
    only: int | None = None,
) -> Board:
    """The board; what is left open is all there is, or what a quick one has."""
    if tasks is not None and only is not None:
        raise InputError(
            f"--tasks {tasks} --task {only}: a number of tasks, or one of them alone; leave one out"
        )
    if networks is None and quick:
        networks = [",".join(QUICK_NETWORKS)]
    board = Board(
        tasks=tasks or (QUICK_TASKS if quick else TASKS),
        seed=seed,
        scenes=_named("--scenes", scenes, tuple(SCENES)),
        methods=_methods(methods),
        operators=_named("--operators", operators, tuple(OPERATORS)),
        only=only,
        networks=dict(NETWORKS) if networks is None else networks_named(networks),
    )
    return board


def _named(
    option: str, text: str, known: tuple[str, ...], fits: Callable[[str], bool] | None = None
) -> tuple[str, ...]:
    """Names with commas between, in the given order, each once; nothing is all of them."""
    names = tuple(dict.fromkeys(name.strip() for name in text.split(",") if name.strip()))
    if not names and not text:
        return known
    for name in names:
        if name not in known and not (fits is not None and fits(name)):
            raise InputError(f"{option} {name!r}: must be some of {', '.join(known)}")
    if not names:
        raise InputError(f"{option} {text!r}: names none of {', '.join(known)}")
    return names


def _methods(text: str) -> tuple[str, ...]:
    names = _named("--methods", text, METHODS.names(), lambda name: ":" in name)
    for name in names:
        _check(name)
    return names


def _check(name: str) -> None:
    """Raise InputError where a method's settings make no sense, on a task of the sphere, before anything is posed."""
    method = method_named(name)
    with method.known():
        made(f"--methods {name!r}", lambda: applied(method, load_scenario("point-obstacle")))
