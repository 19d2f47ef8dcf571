"""What the operator's program leaves behind at the end of a run, and the tally that it keeps meanwhile."""

from collections import Counter

import msgspec

from farhand.common.messages.report import ControlReport
from farhand.common.result_file import this_program

GOOD_STATUS = ("optimal", "shortcut", "idle")
"""A solver's status that is no failure."""

Sample = tuple[float, float | None, float, float, float | None]
"""(t, rtt, sigma, inflation, clearance) of a tick: s since the first motion command, s, m, m, m."""

Span = tuple[float, float]
SILENT_AFTER_NS = 500_000_000
REMEMBERED_SILENCES = 1000
GUARD_APART_NS = 500_000_000
"""Between two reports of the guard's doing; what is nearer is one time."""


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
        states: of the robot that arrived.
        longest_silence: longest time without a state, from the first on (s).
        standing: ticks in which the robot made no progress for 3 s, by what held it.
        lag: time constant with which the robot followed its commands, as identified from its states (s); None: they did
            not tell.
        acceleration: limit that it was seen to meet (m/s^2); None: none was.
    """

    ticks: int = 0
    interventions: int = 0
    infeasible: int = 0
    overruns: int = 0
    lateness_p99: float | None = None
    duration: float = 0.0
    rtt_mean: float | None = None
    rtt_std: float | None = None
    states: int = 0
    longest_silence: float = 0.0
    standing: dict[str, int] = msgspec.field(default_factory=dict)
    lag: float | None = None
    acceleration: float | None = None


class OperatorResult(OperatorCounts, frozen=True, kw_only=True, tag_field="program", tag="operator"):
    """What the operator's side saw and did.

    Attributes:
        version, written_by: of the file.
        finished: the device has nothing left to do.
        has_realtime_priority: whether SCHED_FIFO was granted.
        solver: what solved.
        notice: what is to be said about it to people; may be empty.
        series: a sample a tick.
        silences: (from, to) of times in which no state came, or none that answered, for more than 0.5 s; s since
            the first motion command; the first thousand.
        guarding: (from, to) of times in which the guard on the robot acted, as the operator was told; s since the first
            motion command; the first thousand.
        last_report: the newest report.
    """

    version: int = 1
    written_by: str = msgspec.field(default_factory=this_program)
    finished: bool
    has_realtime_priority: bool = False
    solver: str
    notice: str = ""
    series: list[Sample] = msgspec.field(default_factory=list)
    silences: list[Span] = msgspec.field(default_factory=list)
    guarding: list[Span] = msgspec.field(default_factory=list)
    last_report: ControlReport | None = None


class Tally:
    """Counts what the reports of a run say."""

    def __init__(self) -> None:
        self.ticks = 0
        self.interventions = 0
        self.infeasible = 0
        self.longest_silence = 0.0
        self.standing: Counter[str] = Counter()
        self.last: ControlReport | None = None
        self._silences: list[tuple[int, int]] = []
        self._guarding: list[tuple[int, int]] = []
        self._silent_ns: int | None = None

    def add(self, report: ControlReport) -> None:
        """Count one tick."""
        self.ticks += 1
        self.interventions += report.intervening
        self.infeasible += report.status not in GOOD_STATUS
        if report.safety is not None:
            self.longest_silence = max(self.longest_silence, report.state_age)
            self._note_silence(report)
        if report.held_by:
            self.standing[report.held_by] += 1
        if report.guard is not None:
            self._note_guard(report.t_sent_ns)
        self.last = report

    def guarding(self, origin_ns: int) -> list[Span]:
        """See OperatorResult; `origin_ns` is the first motion command's instant."""
        return [((begin - origin_ns) * 1e-9, (end - origin_ns) * 1e-9) for begin, end in self._guarding]

    def silences(self, origin_ns: int) -> list[Span]:
        """See OperatorResult; `origin_ns` is the first motion command's instant."""
        spans = list(self._silences)
        if self._silent_ns is not None and self.last is not None:
            spans.append((self._silent_ns, self.last.t_sent_ns))
        return [((begin - origin_ns) * 1e-9, (end - origin_ns) * 1e-9) for begin, end in spans]

    def counts(self) -> OperatorCounts:
        """What it counted; what only the program knows is left at its default."""
        return OperatorCounts(
            ticks=self.ticks,
            interventions=self.interventions,
            infeasible=self.infeasible,
            states=self.last.states if self.last is not None else 0,
            longest_silence=self.longest_silence,
            standing=dict(self.standing),
        )

    def _note_guard(self, now_ns: int) -> None:
        """Begin a time in which the guard acted, or go on with it."""
        spans = self._guarding
        if spans and now_ns - spans[-1][1] <= GUARD_APART_NS:
            spans[-1] = spans[-1][0], now_ns
        elif len(spans) < REMEMBERED_SILENCES:
            spans.append((now_ns, now_ns))

    def _note_silence(self, report: ControlReport) -> None:
        """Begin, go on with or end a silence; an answer takes a round trip, which is none."""
        unanswered = report.age - (report.rtt or 0.0)
        silent_ns = round(max(report.state_age, unanswered) * 1e9)
        if silent_ns > SILENT_AFTER_NS:
            if self._silent_ns is None:
                self._silent_ns = report.t_sent_ns - silent_ns
        elif self._silent_ns is not None:
            if len(self._silences) < REMEMBERED_SILENCES:
                self._silences.append((self._silent_ns, report.t_sent_ns))
            self._silent_ns = None


def sample_of(report: ControlReport, origin_ns: int) -> Sample:
    """A report as a sample of the series; `origin_ns` is the first motion command's instant."""
    t = (report.t_sent_ns - origin_ns) * 1e-9
    return t, report.rtt, report.sigma, report.inflation, report.clearance
