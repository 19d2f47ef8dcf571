"""The settings of the margin."""

from typing import Annotated

from msgspec import Meta

from farhand.common.scenario.section import KindSection


class MarginSettings(KindSection, frozen=True, kw_only=True):
    """Safety margins; what a law alone needs is in the table named after it.

    Attributes:
        kind: which law.
        rtt_window: samples of the round-trip statistics.
        innovation_window: samples of the innovation maximum.
    """

    kind: str = "adaptive"
    rtt_window: Annotated[int, Meta(ge=2, le=10_000)] = 30
    innovation_window: Annotated[int, Meta(ge=1, le=100_000)] = 100
