"""The settings of the margin."""

from typing import Annotated

from msgspec import Meta

from farhand.common.scenario.section import KindSection


class MarginSettings(KindSection, frozen=True, kw_only=True):
    """Safety margins; what a law alone needs is in the table named after it.

    Attributes:
        kind: which law.
        rtt_span: time of the round-trip statistics (s); one command a tick is a sample, 30 at the paper's 10 Hz.
        innovation_span: time of the innovation maximum (s).
    """

    kind: str = "adaptive"
    rtt_span: Annotated[float, Meta(gt=0, le=1000)] = 3.0
    innovation_span: Annotated[float, Meta(gt=0, le=10_000)] = 10.0
