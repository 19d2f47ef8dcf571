"""What the operator's program leaves behind at the end of a run, and the tally that it keeps meanwhile."""

import msgspec

from farhand.common.messages.report import ControlReport
from farhand.common.result_file import this_program

GOOD_STATUS = ("optimal", "shortcut", "idle")
"""A solver's status that is no failure."""

Sample = tuple[float, float | None, float, float, float | None]
"""(t, rtt, sigma, inflation, clearance) of a tick: s since the first motion command, s, m, m, m."""


class OperatorCounts(msgspec.Struct, frozen=True, kw_only=True):
    """What the operator's side counted and measured; all of it stands in a run's summary, too.

    Attributes:
        ticks: control ticks.
        interventions: of them, those in which something binds or a reason stands (see ControlReport.intervening).
        infeasible: those in which the solver found no plan that meets every constraint.
        overruns: late ticks.
        lateness_p99: of the ticks (s); None in virtual time.
        duration: from the first motion command to the end (s).
        rtt_mean, rtt_std: measured network round trip with computing (s); None if never measured.
    """

    ticks: int = 0
    interventions: int = 0
    infeasible: int = 0
    overruns: int = 0
    lateness_p99: float | None = None
    duration: float = 0.0
    rtt_mean: float | None = None
    rtt_std: float | None = None


class OperatorResult(OperatorCounts, frozen=True, kw_only=True):
    """What the operator's side saw and did.

    Attributes:
        version, written_by: of the file.
        finished: the device has nothing left to do.
        has_realtime_priority: whether SCHED_FIFO was granted.
        solver: what solved.
        notice: what is to be said about it to people; may be empty.
        series: a sample a tick.
        last_report: the newest report.
    """

    version: int = 1
    written_by: str = msgspec.field(default_factory=this_program)
    finished: bool
    has_realtime_priority: bool = False
    solver: str
    notice: str = ""
    series: list[Sample] = msgspec.field(default_factory=list)
    last_report: ControlReport | None = None


class Tally:
    """Counts what the reports of a run say."""

    def __init__(self) -> None:
        self.ticks = 0
        self.interventions = 0
        self.infeasible = 0
        self.last: ControlReport | None = None

    def add(self, report: ControlReport) -> None:
        """Count one tick."""
        self.ticks += 1
        self.interventions += report.intervening
        self.infeasible += report.status not in GOOD_STATUS
        self.last = report


def sample_of(report: ControlReport, origin_ns: int) -> Sample:
    """A report as a sample of the series; `origin_ns` is the first motion command's instant."""
    t = (report.t_sent_ns - origin_ns) * 1e-9
    return t, report.rtt, report.sigma, report.inflation, report.clearance
