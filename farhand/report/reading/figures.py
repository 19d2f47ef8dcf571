"""The figures of a run: what the report's tables show and what `--json` gives. SI units."""

import msgspec
import numpy as np

from farhand.common.geometry import Array
from farhand.common.timing.clock import utc_words
from farhand.foxglove.happenings import OVER_NS
from farhand.report.reading import sources
from farhand.report.reading.evidence import Evidence
from farhand.report.reading.margin import additive, coverage, width_of
from farhand.report.reading.settings import changed
from farhand.report.reading.spans import Span, joined, seconds_of
from farhand.report.reading.story import Story

SCHEMA = "farhand-report-2"
"""Fields may be added; what one means, or that it goes, raises the number."""
LASTING = ("hold", "wait", "stuck")
"""Kinds of what is told by reason: several may be so at once, and one follows another."""


class Spread(msgspec.Struct, frozen=True, kw_only=True):
    """Some values: how many, mean, median, the 99th of a hundred, largest."""

    count: int
    mean: float
    p50: float
    p99: float
    max: float


class Way(msgspec.Struct, frozen=True, kw_only=True):
    """One direction at the emulator: messages with copies, lost by cause, delays of the delivered (s)."""

    messages: int
    lost: dict[str, int]
    corrupted: int
    delay: Spread | None


class Happened(msgspec.Struct, frozen=True, kw_only=True):
    """Something that happened: kind, from and to (s since `zero`), words, and facts as text."""

    kind: str
    begin: float
    end: float
    words: str
    facts: dict[str, str]


class Figures(msgspec.Struct, frozen=True, kw_only=True):
    """All of a run; None is what is unknown.

    Attributes:
        lacks: what is missing, in words; the figures are those of the rest.
        scenario, robot, operator, uplink, downlink, margin, predictor, controller, solver, seed: what was run.
        clock: `real` or `virtual`; began: UTC of the operator's host; None in virtual time.
        zero: from what on times are counted, in words: the first motion command, where it is recorded.
        duration: from the first motion command to the end (s); recorded: from the first tick in the recording to the
            last (s); ticks, states: in the recording.
        whole: every tick of the run is in the recording; else what is counted in it, `happened` and `events`, may lack
            some.
        sources: whose word a figure is, by its name, where it is not the recording's.
        safe, finished: by the robot's and the operator's own results; `safe` is false as well where the recording
            alone shows it.
        slow: that the machine did not keep up, in words.
        targets_reached, targets: by the operator's result, else as last recorded.
        limit: distance to keep (m).
        clearance: the least of the tool's sphere that the robot measured, told by its result or else its states (m).
        arm_clearance: likewise of the whole arm.
        margin_width, margin_parts: in force (m); parts as means of what each added.
        coverage: ticks that are judged, and the share of them in which the newest error of the prediction was within
            the margin of the tick before.
        prediction_error: (m).
        speed_asked, speed_done: while driving (m/s).
        happened: times and seconds of each kind, as the operator's side was told of them; what is so for two reasons
            at once, as when the operator's side commands zero and the robot holds, is counted once.
        guard: times and seconds in which the guard acted, by the robot's own count; None: unknown, or it is off.
        stops, refused: that latched, and commands, as the robot counted or last told.
        refused_by: these commands by reason, by the robot's result; None: unknown.
        filtered_ticks: ticks in which the filter intervened, by the operator's result.
        round_trip, age, state_age: (s); loss: share of the states between the first and the last that never arrived.
        network: at the emulator, by direction; empty where not recorded.
        emulator: messages and how many were lost by the emulator's own result, by direction; it has those as well that
            came before and after what is recorded.
        period: of a tick (s); tick_late: how much later than a period after the one before (s); solve: (s).
        overruns: late ticks, as the operator counted.
        robot_loop: lateness of the robot's loop: p50, p99, max (s).
        changed: settings that are not the defaults, with the default.
        versions, git: of what ran.
        events: everything that happened.
    """

    name: str
    lacks: list[str]
    scenario: str
    robot: str
    operator: str
    uplink: str | None
    downlink: str | None
    margin: str
    predictor: str | None
    controller: str
    solver: str
    seed: int
    clock: str
    began: str | None
    zero: str
    duration: float | None
    recorded: float
    whole: bool
    sources: dict[str, str]
    ticks: int
    states: int
    safe: bool | None
    finished: bool | None
    why: str
    slow: str
    targets_reached: int | None
    targets: int | None
    limit: float | None
    clearance: float | None
    arm_clearance: float | None
    margin_width: Spread | None
    margin_parts: dict[str, float]
    coverage: tuple[int, float] | None
    prediction_error: Spread | None
    speed_asked: Spread | None
    speed_done: Spread | None
    happened: dict[str, tuple[int, float]]
    guard: tuple[int, float] | None
    stops: int | None
    refused: int | None
    refused_by: dict[str, int] | None
    filtered_ticks: int | None
    round_trip: Spread | None
    age: Spread | None
    state_age: Spread | None
    loss: float | None
    network: dict[str, Way]
    emulator: dict[str, tuple[int, int]]
    period: float | None
    tick_late: Spread | None
    solve: Spread | None
    overruns: int | None
    robot_loop: tuple[float, float, float] | None
    changed: dict[str, tuple[object, object]]
    versions: dict[str, str]
    git: str
    events: list[Happened]


def figures_of(run: Evidence) -> Figures:
    """All figures of a run."""
    story, summary = run.story, run.summary
    ticks, info = story.ticks, story.info
    driving, seen = ticks["driving"] > 0, ticks["seen"] > 0
    limit, targets = limit_of(story), sources.targets_of(run)
    robot, operator = run.robot, sources.operator_of(run)
    late = robot.lateness if robot is not None else None
    return Figures(
        name=run.name,
        lacks=run.lacks,
        scenario=str(info.scenario.get("name", "")),
        robot=info.robot,
        operator=info.operator,
        uplink=_network(run, "uplink"),
        downlink=_network(run, "downlink"),
        margin=_kind(story, "margin"),
        predictor=summary.predictor if summary is not None else None,
        controller=_kind(story, "controller"),
        solver=info.solver,
        seed=info.seed,
        clock=info.clock,
        began=utc_words(info.epoch_ns + story.began_ns) if info.epoch_ns and ticks.rows else None,
        zero=story.zero,
        duration=sources.duration_of(run),
        recorded=story.length,
        whole=run.whole,
        sources=sources.sources_of(run),
        ticks=ticks.rows,
        states=story.states.rows,
        safe=sources.safe_of(run, limit),
        finished=summary.finished if summary is not None and summary.end_known else None,
        why=_why(run),
        slow=summary.slow if summary is not None else "",
        targets_reached=targets[0] if targets is not None else None,
        targets=targets[1] if targets is not None else None,
        limit=limit,
        clearance=sources.clearance_of(run),
        arm_clearance=sources.arm_of(run),
        margin_width=spread(width_of(story)[seen]),
        margin_parts={
            name: float(value[seen].mean()) for name, value in additive(story)[0].items() if seen.any()
        },
        coverage=coverage(story),
        prediction_error=spread(ticks["error"][seen]),
        speed_asked=spread(ticks["asked"][driving]),
        speed_done=spread(ticks["done"][driving]),
        happened=_happened(story),
        guard=(robot.guard_times, robot.guard_seconds) if robot is not None and robot.guarded else None,
        stops=sources.stops_of(run),
        refused=sources.refused_of(run),
        refused_by=dict(sorted(robot.refused.items())) if robot is not None else None,
        filtered_ticks=operator.interventions if operator is not None else None,
        round_trip=spread(_changes(ticks["rtt"])),
        age=spread(ticks["age"][seen]),
        state_age=spread(ticks["state_age"]),
        loss=_loss(story),
        network={
            name: Way(
                messages=way.messages,
                lost=dict(sorted(way.lost.items())),
                corrupted=way.corrupted,
                delay=spread(way.delays),
            )
            for name, way in sorted(story.network.ways.items())
        },
        emulator=sources.emulator_of(run),
        period=period_of(story),
        tick_late=spread(lateness(story)[1]) if info.clock == "real" else None,
        solve=spread(ticks["solve"][driving]) if ticks["solve"].any() else None,
        overruns=sources.overruns_of(run),
        robot_loop=(late.p50, late.p99, late.max) if late is not None else None,
        changed=changed(info.scenario),
        versions=dict(sorted(info.versions.items())),
        git=info.git,
        events=[
            Happened(
                kind=each.kind,
                begin=story.since(each.began_ns),
                end=story.since(each.seen_ns),
                words=each.words,
                facts=each.facts,
            )
            for each in story.happenings
        ],
    )


def spread(values: Array) -> Spread | None:
    """Of those that are known; None: none is."""
    known = values[np.isfinite(values)]
    if not len(known):
        return None
    p50, p99 = np.percentile(known, (50, 99))
    return Spread(
        count=len(known), mean=float(known.mean()), p50=float(p50), p99=float(p99), max=float(known.max())
    )


def limit_of(story: Story) -> float | None:
    """The distance to keep (m)."""
    return story.info.kept


def period_of(story: Story) -> float | None:
    """Of a tick (s): a step of a plan, where the operator has no rate of its own."""
    return story.info.tick_period


def lateness(story: Story) -> tuple[Array, Array]:
    """(m,) instants, and by how much each tick came later than a period after the one before (s); both are there."""
    period, t = period_of(story), story.ticks["t"]
    if period is None or len(t) < 2:
        return np.zeros(0), np.zeros(0)
    follows = np.diff(story.ticks["number"]) == 1
    late = np.maximum(0.0, np.round(np.diff(t)[follows] - period, 9))
    return t[1:][follows], late


def _kind(story: Story, section: str) -> str:
    table = story.info.scenario.get(section)
    return str(table.get("kind", "")) if isinstance(table, dict) else ""


def _network(run: Evidence, way: str) -> str | None:
    if run.summary is not None:
        return str(getattr(run.summary, way))
    table = run.story.info.scenario.get("network")
    said = table.get(way) if isinstance(table, dict) else None
    return str(said) if said is not None else None


def _why(run: Evidence) -> str:
    summary = run.summary
    return "; ".join(each for each in (summary.too_near, summary.why) if each) if summary is not None else ""


def _happened(story: Story) -> dict[str, tuple[int, float]]:
    """What lasts is counted by its stretches, once where it was so for two reasons, else each by itself."""
    spans: dict[str, list[Span]] = {}
    for each in story.happenings:
        spans.setdefault(each.kind, []).append((story.since(each.began_ns), story.since(each.seen_ns)))
    found = {kind: joined(s, OVER_NS * 1e-9) if kind in LASTING else s for kind, s in spans.items()}
    return {kind: (len(stretches), seconds_of(stretches)) for kind, stretches in sorted(found.items())}


def _loss(story: Story) -> float | None:
    """By their numbers; a robot that was started anew counts anew."""
    sent = arrived = 0
    for session in np.unique(story.states["session"]):
        numbers = np.unique(story.states["seq"][story.states["session"] == session])
        sent += int(numbers[-1] - numbers[0]) + 1
        arrived += len(numbers)
    return 1.0 - arrived / sent if sent else None


def _changes(values: Array) -> Array:
    """Each measured value once: it stays in the reports until there is a newer one."""
    known = values[np.isfinite(values)]
    new: Array = known[np.diff(known, prepend=np.nan) != 0.0]
    return new
