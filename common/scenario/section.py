"""The sections of a scenario: typed settings, and those that name a kind and hold the kinds' own settings."""

from typing import Annotated, Any

import msgspec
from msgspec import Meta, Struct

from farhand.common.errors import ScenarioError
from farhand.common.scenario.known_keys import explained

Fraction = Annotated[float, Meta(gt=0, le=1)]
Rate = Annotated[float, Meta(gt=0, le=10_000)]


class Section(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Settings that belong together; whoever reads them defines them. SI units, `_hz` names a rate."""


class NoSettings(Section, frozen=True, kw_only=True):
    """Of a kind that has no settings of its own."""


class KindSection(Section, frozen=True, kw_only=True):
    """A section that chooses a kind.

    Attributes:
        kind: name of the kind in force.
        own: each kind's own settings by its name; in TOML the sub-tables: `[margin.adaptive]`.
    """

    kind: str
    own: dict[str, dict[str, Any]] = msgspec.field(default_factory=dict)


def own_settings(section: KindSection, kind: Any, where: str) -> Any:
    """The own settings of the kind in force, as its `Settings`.

    Args:
        section: names the kind and holds its table.
        kind: the kind's class; one without `Settings` has none of its own.
        where: dotted name of the section, e.g. "margin".

    Raises:
        ScenarioError: the table does not fit, with the key's name.
    """
    return checked_settings(section.own.get(section.kind, {}), kind, f"{where}.{section.kind}")


def checked_settings(table: dict[str, Any], kind: Any, where: str) -> Any:
    """A kind's own table as its `Settings`; `where` is the table's dotted name. Raises ScenarioError."""
    settings = getattr(kind, "Settings", NoSettings)
    try:
        return msgspec.convert(table, settings)
    except msgspec.ValidationError as error:
        raise ScenarioError(explained(str(error), settings, where)) from None
