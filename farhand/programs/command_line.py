"""The words of the programs' command lines, spelled here alone.

Each class is one command: a field is the option of its name, `listen_operator` is `--listen-operator`; what is
empty or None is left out, as the command has a default of its own. A test holds them against the commands.
"""

from dataclasses import dataclass, field, fields
from typing import ClassVar

DEFAULT_SCENARIO, DEFAULT_NETWORK = "ur5-obstacle", "5g-urban"
"""What is driven, and over what where the scenario says nothing of a network."""


@dataclass(frozen=True, kw_only=True)
class Words:
    """A command of `farhand` and its options.

    Attributes:
        COMMAND: its name.
        SPELLED: options that are not called as their field.
    """

    COMMAND: ClassVar[str]
    SPELLED: ClassVar[dict[str, str]] = {"settings": "--set", "as_json": "--json"}

    @classmethod
    def options(cls) -> dict[str, str]:
        """The option of each field, such as `--time-limit`."""
        names = (each.name for each in fields(cls) if each.metadata.get("argument") is None)
        return {name: cls.SPELLED.get(name, f"--{name.replace('_', '-')}") for name in names}

    def words(self) -> list[str]:
        """What follows `farhand`."""
        found = [self.COMMAND]
        found += [str(getattr(self, each.name)) for each in fields(self) if each.metadata.get("argument")]
        for name, option in self.options().items():
            value = getattr(self, name)
            if value is True:
                found.append(option)
            elif isinstance(value, tuple):
                found += [word for each in value for word in (option, str(each))]
            elif value is not None and value is not False and value != "":
                found += [option, str(value)]
        return found


@dataclass(frozen=True, kw_only=True)
class Secured(Words):
    """What the programs that meet others have in common.

    Attributes:
        tls: certificate folder; empty: no TLS.
        insecure: listen beyond this host without it.
    """

    tls: str = ""
    insecure: bool = False


@dataclass(frozen=True, kw_only=True)
class NetemWords(Secured):
    """`farhand netem`; see NetemSettings."""

    COMMAND: ClassVar[str] = "netem"

    listen_operator: str = ""
    listen_robot: str = ""
    connect_operator: tuple[str, ...] = ()
    connect_robot: tuple[str, ...] = ()
    router: bool = False
    network: str = ""
    uplink: str = ""
    downlink: str = ""
    robot_network: tuple[str, ...] = ()
    seed: int | str | None = None
    timeline: str | None = None
    stats: str = ""
    log: str = ""
    control: str = ""
    metrics: int | None = None
    ready_file: str = ""
    backend: str = ""


@dataclass(frozen=True, kw_only=True)
class RobotWords(Secured):
    """`farhand robot`."""

    COMMAND: ClassVar[str] = "robot"

    scenario: str = ""
    guard: str = ""
    settings: tuple[str, ...] = ()
    robot: str = ""
    connect: tuple[str, ...] = ()
    listen: tuple[str, ...] = ()
    router: bool = False
    result: str = ""


@dataclass(frozen=True, kw_only=True)
class CameraWords(Secured):
    """`farhand camera`."""

    COMMAND: ClassVar[str] = "camera"

    camera: str = ""
    scenario: str = ""
    settings: tuple[str, ...] = ()
    robot: str = ""
    connect: tuple[str, ...] = ()
    listen: tuple[str, ...] = ()
    router: bool = False
    size: str = ""
    rate: float | str | None = None
    quality: int | str | None = None


@dataclass(frozen=True, kw_only=True)
class ControlChoice(Words):
    """What decides, in an operator's program and in a summary: scenario, margin, predictor, solver, seed."""

    scenario: str = ""
    settings: tuple[str, ...] = ()
    margin: str = ""
    predictor: str = ""
    solver: str = ""
    seed: int | str | None = None


@dataclass(frozen=True, kw_only=True)
class OperatorWords(ControlChoice, Secured):
    """`farhand operator`."""

    COMMAND: ClassVar[str] = "operator"

    name: str = ""
    robot: str = ""
    connect: tuple[str, ...] = ()
    listen: tuple[str, ...] = ()
    router: bool = False
    report: str = ""
    time_limit: float | str | None = None
    result: str = ""


@dataclass(frozen=True, kw_only=True)
class RecordWords(Words):
    """`farhand record`."""

    COMMAND: ClassVar[str] = "record"

    out: str = ""
    connect: str = ""
    netem: str = ""
    robot: str = ""


@dataclass(frozen=True, kw_only=True)
class ConsoleWords(Words):
    """`farhand console`."""

    COMMAND: ClassVar[str] = "console"
    SAYS: ClassVar[str] = "drive at"
    """What its line begins with once it answers."""
    SPELLED: ClassVar[dict[str, str]] = Words.SPELLED | {"opens": "--open"}

    connect: str = ""
    listen: str = ""
    robot: str = ""
    token: str = ""
    tls: str = ""
    netem: str = ""
    opens: bool = False


@dataclass(frozen=True, kw_only=True)
class SteerWords(Words):
    """`farhand steer`.

    Attributes:
        device: what steers.
    """

    COMMAND: ClassVar[str] = "steer"

    device: str = field(metadata={"argument": True})
    connect: str = ""
    robot: str = ""
    scenario: str = ""
    settings: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class SummariseWords(ControlChoice):
    """`farhand summarise`.

    Attributes:
        folder: of the run.
        why: what went wrong, where the files cannot say it.
    """

    COMMAND: ClassVar[str] = "summarise"

    folder: str = field(metadata={"argument": True})
    network: str = ""
    uplink: str = ""
    downlink: str = ""
    why: str = ""
    as_json: bool = False
