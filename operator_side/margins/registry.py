"""The margin laws by name. A new one is one file and one line here, or an entry point of another package."""

from typing import TYPE_CHECKING

from farhand.common.kinds import Kinds, made
from farhand.common.scenario.section import own_settings
from farhand.operator_side.margins.settings import MarginSettings

if TYPE_CHECKING:
    from farhand.operator_side.margins.law import MarginLaw

MARGINS: "Kinds[type[MarginLaw]]" = Kinds(
    "margin law",
    "farhand.margins",
    "farhand.operator_side.margins.law:MarginLaw",
    {
        "none": "farhand.operator_side.margins.none:NoMargin",
        "paper": "farhand.operator_side.margins.paper:PaperMargin",
        "watchful": "farhand.operator_side.margins.watchful:WatchfulMargin",
        "adaptive": "farhand.operator_side.margins.adaptive:AdaptiveMargin",
        "worst-case": "farhand.operator_side.margins.worst_case:WorstCaseMargin",
    },
)


def make_margin(settings: MarginSettings) -> "MarginLaw":
    """The law that the settings name; raises InputError."""
    law = MARGINS.get(settings.kind, "margin.kind")
    own = own_settings(settings, law, "margin")
    return made(f"margin law {settings.kind!r}", lambda: law(own))
