"""The prediction laws by name. A new one is one file and one line here, or an entry point of another package."""

from typing import TYPE_CHECKING

from farhand.common.kinds import Kinds

if TYPE_CHECKING:
    from farhand.operator_side.prediction.law import StatePredictor

PREDICTORS: "Kinds[type[StatePredictor]]" = Kinds(
    "prediction law",
    "farhand.predictors",
    "farhand.operator_side.prediction.law:StatePredictor",
    {
        "none": "farhand.operator_side.prediction.none:NoPrediction",
        "last-command": "farhand.operator_side.prediction.last_command:LastCommand",
        "history": "farhand.operator_side.prediction.history:History",
        "echo": "farhand.operator_side.prediction.echo:EchoPrediction",
        "timeline": "farhand.operator_side.prediction.timeline:Timeline",
        "known-delay": "farhand.operator_side.prediction.known_delay:KnownDelay",
    },
)
