"""A run: which task over which network, with which draws, for how long. Made once, at the edge; handed on whole."""

import math
from typing import Any

import msgspec

from farhand.common.errors import InputError, SpecError
from farhand.netem.spec import Spec, parse_spec
from farhand.runs.scenario import Scenario, scenario_to_table

TIME_LIMIT = 90.0
"""Of a task, from the first motion command (s), where nothing else is said."""
COMPUTING_TIME = 0.02
"""Modelled duration of a control tick (s): zero would flatter the controller."""


class Way(msgspec.Struct, frozen=True):
    """One direction of a network: as it was written, and what that means."""

    text: str
    spec: Spec

    def __str__(self) -> str:
        """As it was written."""
        return self.text


def read_way(text: str) -> Way:
    """One direction from a SPEC, its files opened; raises SpecError, or InputError for a file."""
    if not text.strip():
        raise SpecError(f"network {text!r}: at character 1: expected a SPEC such as constant:200 or none")
    spec = parse_spec(text)
    spec.prepare()
    return Way(text, spec)


class Network(msgspec.Struct, frozen=True, kw_only=True):
    """Both directions of a network."""

    uplink: Way
    downlink: Way

    def __str__(self) -> str:
        """`5g-urban`, or `UPLINK / DOWNLINK` where they differ."""
        up, down = self.uplink.text, self.downlink.text
        return up if up == down else f"{up} / {down}"


class NetworkChoice(msgspec.Struct, frozen=True, kw_only=True):
    """What somebody says of the network: of both directions, and of each; None: not said."""

    network: Way | None = None
    uplink: Way | None = None
    downlink: Way | None = None

    def of(self, direction: str) -> Way | None:
        """What is said of `uplink` or `downlink`."""
        own: Way | None = getattr(self, direction)
        return self.network if own is None else own


NOTHING_SAID = NetworkChoice()


def read_choice(
    network: str | None = None, uplink: str | None = None, downlink: str | None = None
) -> NetworkChoice:
    """A choice from SPECs; raises InputError."""
    texts = {"network": network, "uplink": uplink, "downlink": downlink}
    return NetworkChoice(**{name: read_way(text) for name, text in texts.items() if text is not None})


def left_open(scenario: Scenario, choice: NetworkChoice) -> list[str]:
    """The directions of which neither the choice nor the scenario says anything."""
    return [
        direction
        for direction in ("uplink", "downlink")
        if choice.of(direction) is None and getattr(scenario.network, direction) is None
    ]


def choose_network(
    scenario: Scenario, choice: NetworkChoice = NOTHING_SAID, *, default: str = "none", where: str = ""
) -> Network:
    """The network in force: the choice goes before the scenario's, and that before the default.

    Args:
        scenario: its section `network`.
        choice: of the command line, a sweep's point, a marker.
        default: SPEC of both directions.
        where: the scenario's file or name, for errors; empty takes its name.

    Raises:
        InputError: a SPEC of the scenario, or a file that it names, cannot be read; names key and file.
    """
    ways = []
    for direction in ("uplink", "downlink"):
        way, text = choice.of(direction), getattr(scenario.network, direction)
        if way is None and text is not None:
            try:
                way = read_way(text)
            except InputError as error:
                source = f"scenario {where or scenario.name}: network.{direction}"
                raise type(error)(f"{source}: {error}") from None
        ways.append(read_way(default) if way is None else way)
    return Network(uplink=ways[0], downlink=ways[1])


class Run(msgspec.Struct, frozen=True, kw_only=True):
    """One run; it may travel between processes.

    Attributes:
        scenario: what to do.
        network: over what; the scenario's own section of that name is of no account any more.
        seed: of every random stream.
        time_limit: of the task, from the first motion command (s).
        computing_time: modelled, of a control tick in virtual time (s); several values are a measured
            distribution, drawn from with replacement.
        timeline: TOML file of changes of the network at given times.
    """

    scenario: Scenario
    network: Network
    seed: int = 0
    time_limit: float = TIME_LIMIT
    computing_time: tuple[float, ...] = (COMPUTING_TIME,)
    timeline: str | None = None

    @classmethod
    def over(
        cls,
        scenario: Scenario,
        network: str | None = None,
        *,
        uplink: str | None = None,
        downlink: str | None = None,
        seed: int = 0,
    ) -> "Run":
        """A run over a network from SPECs; what they leave open is the scenario's, else `none`.

        Raises InputError. For the other fields: `msgspec.structs.replace(run, time_limit=30.0)`.
        """
        choice = read_choice(network, uplink, downlink)
        return cls(scenario=scenario, network=choose_network(scenario, choice), seed=seed)

    def __post_init__(self) -> None:
        """Raises InputError for numbers that make no sense."""
        if self.seed < 0:
            raise InputError(f"seed {self.seed}: must be 0 or more")
        if not 0.0 < self.time_limit < math.inf:
            raise InputError(f"time_limit {self.time_limit:g}: must be more than 0 s")
        if not self.computing_time or not all(0.0 <= each < math.inf for each in self.computing_time):
            raise InputError("computing_time: must be 0 s or more")

    def check(self) -> None:
        """Raise InputError where its files cannot be used."""
        if self.timeline:
            from farhand.netem.timeline import load_timeline

            load_timeline(self.timeline)

    def table(self) -> dict[str, Any]:
        """The scenario with the network in force, as nested dictionaries: what can be run again."""
        network = {"uplink": self.network.uplink.text, "downlink": self.network.downlink.text}
        return scenario_to_table(self.scenario) | {"network": network}
