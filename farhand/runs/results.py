"""What programs leave behind at the end of a run."""

import msgspec

from farhand.common.messages.report import ControlReport


class OperatorResult(msgspec.Struct, frozen=True, kw_only=True):
    """What the operator's program leaves behind; `series` holds (t, rtt, sigma, inflation, clearance)."""

    finished: bool
    duration: float
    rtt_mean: float | None
    rtt_std: float | None
    ticks: int
    interventions: int
    infeasible: int
    overruns: int
    lateness_p99: float
    has_realtime_priority: bool
    solver: str
    notice: str
    series: list[tuple[float, float | None, float, float, float | None]]
    last_report: ControlReport | None
