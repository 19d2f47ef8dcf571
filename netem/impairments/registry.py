"""The words of a SPEC: those of Farhand, one line each, and those that installed packages bring.

A package brings a word by an entry point of the group `farhand.impairments`, whose name is the word's.
"""

from farhand.common.errors import InputError
from farhand.common.kinds import Kinds
from farhand.netem.impairments.base import Word
from farhand.netem.models.profiles import PROFILES

_HERE = "farhand.netem.impairments"
BUILT_IN = {
    "constant": f"{_HERE}.constant:Constant",
    "uniform": f"{_HERE}.uniform:Uniform",
    "gaussian": f"{_HERE}.gaussian:Gaussian",
    "normal": f"{_HERE}.gaussian:Gaussian",
    "pareto": f"{_HERE}.pareto:Pareto",
    "paretonormal": f"{_HERE}.paretonormal:ParetoNormal",
    "lognormal": f"{_HERE}.lognormal:LogNormal",
    "empirical": f"{_HERE}.delay_by_trace:Empirical",
    "trace": f"{_HERE}.delay_by_trace:DelayByTrace",
    "loss": f"{_HERE}.loss:LossWord",
    "duplicate": f"{_HERE}.duplicate:Duplicate",
    "corrupt": f"{_HERE}.corrupt:Corrupt",
    "rate": f"{_HERE}.rate:Rate",
    "slot": f"{_HERE}.slot:Slot",
    "limit": f"{_HERE}.limit:Limit",
    "reorder": f"{_HERE}.reorder:Reorder",
    "outage": f"{_HERE}.outage:Outage",
    "tcp-like": f"{_HERE}.tcp_like:TcpLike",
    "recorded": f"{_HERE}.recorded:Recorded",
    "model": f"{_HERE}.modelled:ModelWord",
    **dict.fromkeys(PROFILES, f"{_HERE}.modelled:ProfileWord"),
}
IMPAIRMENTS: Kinds[type[Word]] = Kinds("impairment", "farhand.impairments", Word, BUILT_IN)


def word_called(name: str) -> type[Word]:
    """The word of a name in IMPAIRMENTS; raises InputError where a package brings one that is not complete."""
    word = IMPAIRMENTS.get(name)
    if name not in BUILT_IN:
        wanted = ("name", "kind", "stage")
        missing = [each for each in wanted if not hasattr(word, each)]
        if missing:
            raise InputError(
                f"impairment {name!r}: {_path(word)} has no {missing[0]!r}; give it one in its class"
            )
        if word.name != name:
            raise InputError(
                f"impairment {name!r}: {_path(word)} calls itself {word.name!r}; one name for both"
            )
    return word


def kinds() -> tuple[str, ...]:
    """What words act on, in the order of the chain; a word that cannot be loaded is in no network either."""
    found: set[tuple[int, str]] = set()
    for name in IMPAIRMENTS.names():
        try:
            word = word_called(name)
        except InputError:
            continue
        found.add((int(word.stage), word.kind))
    return tuple(dict.fromkeys(kind for _, kind in sorted(found)))


def described() -> list[tuple[str, str]]:
    """How to write each word, and what it does; of one that cannot be loaded, why."""
    rows = []
    for name in IMPAIRMENTS.names():
        try:
            rows.append(word_called(name).describe(name))
        except InputError as error:
            rows.append((name, f"cannot be used: {error}"))
    return list(dict.fromkeys(rows))


def _path(word: type[Word]) -> str:
    return f"{word.__module__}.{word.__qualname__}"
