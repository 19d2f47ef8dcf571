"""How a run ended, for people and as JSON."""

from pathlib import Path

from rich.console import Console
from rich.table import Table
from rich.text import Text

from farhand.common.process.called import called
from farhand.netem.measure.result import DirectionCounts, NetemCounts
from farhand.runs.files import RECORDING, SUMMARY
from farhand.runs.summary import RunSummary, count_reasons, to_json
from farhand.runs.words.guard import guard_summary
from farhand.runs.words.refusals import meaning
from farhand.runs.words.units import milliseconds

SHOWN_STOPS = 5
NO_OPERATOR, NO_ROBOT = (f"unknown: the {who} left no result" for who in ("operator", "robot"))
LAG_OFF, LAG_NEAR = 0.3, 0.02
"""A lag that is off by more than this share, and by more than this (s), is said."""


def print_outcome(
    summary: RunSummary,
    folder: Path | None,
    figure: Path | None,
    console: Console,
    *,
    as_json: bool,
) -> None:
    """Print the summary; with `as_json`, the last line on stdout is the summary as JSON."""
    console.print(_verdict(summary))
    table = Table.grid(padding=(0, 2))
    table.add_column(style="dim", justify="right", no_wrap=True)
    table.add_column(overflow="fold")
    for label, text in _rows(summary):
        table.add_row(label, text)
    drawn = _drawn_against_achieved(summary.counts.netem)
    if drawn:
        table.add_row("netem", drawn)
    _print_unpadded(table, console)
    if summary.slow:
        console.print(summary.slow, style="yellow", markup=False, highlight=False)
    if folder is not None and not (summary.safety_known and summary.end_known):
        _point_to_recording(folder, console)
    if folder is not None:
        names = [SUMMARY, *([figure.name] if figure else [])]
        names += [RECORDING] if (folder / RECORDING).is_file() else []
        console.print(
            Text.assemble(("results in ", "dim"), (f"{folder}/", "bold"), (f"  ({', '.join(names)})", "dim"))
        )
    if as_json:
        print(to_json(summary), flush=True)


def _print_unpadded(table: Table, console: Console) -> None:
    """Without the spaces by which a table fills its lines: they end in files and in what is copied."""
    for segments in console.render_lines(table, pad=False):
        line = Text.assemble(*((each.text, each.style or "") for each in segments))
        line.rstrip()
        console.print(line, highlight=False, soft_wrap=True)


def _point_to_recording(folder: Path, console: Console) -> None:
    if (folder / RECORDING).is_file():
        line = f"its recording holds more than the results: {called()} report {folder}"
        console.print(line, markup=False, highlight=False, soft_wrap=True)


def _verdict(summary: RunSummary) -> Text:
    if not summary.safety_known:
        safe = (" SAFE OR NOT: UNKNOWN ", "bold black on yellow")
    elif summary.safe:
        safe = (" SAFE ", "bold white on green")
    elif summary.driven is False and not summary.too_near:
        safe = (" NOTHING WAS DRIVEN ", "bold black on yellow")
    else:
        safe = (" NOT SAFE ", "bold white on red")
    if not summary.end_known:
        done = (" FINISHED OR NOT: UNKNOWN ", "bold black on yellow")
    elif summary.finished:
        done = (" FINISHED ", "bold white on green")
    else:
        done = (" NOT FINISHED ", "bold black on yellow")
    said = "; ".join(part for part in (summary.too_near, summary.why) if part)
    return Text.assemble(safe, " ", done, f"  {said}" if said else "")


def _rows(summary: RunSummary) -> list[tuple[str, str]]:
    rows = [
        ("clearance", _clearance(summary)),
        ("arm", _arm(summary)),
        ("targets", _targets(summary)),
        ("round trip", _round_trip(summary)),
        ("lost", _lost(summary.counts.netem)),
        ("silence", _silence(summary)),
        ("filter", _filter(summary)),
        ("guard", _guard(summary)),
        ("stops", _stops(summary)),
        ("refused", _refused(summary)),
        ("scene", _scene(summary)),
        ("stood", _stood(summary)),
        ("follows", _follows(summary)),
    ]
    left_out = {"refused"} if not summary.refused else set()
    return [(label, text) for label, text in rows if text and label not in left_out]


def _refused(summary: RunSummary) -> str:
    """How many commands, and a line for each reason."""
    reasons = sorted(summary.refused_by.items())
    lines = [f"{reason} {count}: {meaning(reason)}" for reason, count in reasons]
    return "\n".join([f"{summary.refused} command{'s' if summary.refused != 1 else ''}", *lines])


def _scene(summary: RunSummary) -> str:
    """Changes of the obstacles while it ran; empty: there were none."""
    robot = summary.counts.robot
    if robot is None or not (robot.scene_changes or robot.scene_refused):
        return ""
    refused = sum(robot.scene_refused.values())
    times = "once" if robot.scene_changes == 1 else f"{robot.scene_changes} times"
    told = f"changed {times} while it ran" if robot.scene_changes else "not changed"
    return (
        f"{told}, {refused} request{'s' if refused > 1 else ''} refused: {count_reasons(robot.scene_refused.items())}"
        if refused
        else told
    )


def _clearance(summary: RunSummary) -> str:
    if not summary.safety_known:
        return NO_ROBOT
    if summary.min_clearance is None:
        robot = summary.counts.robot
        return (
            "no obstacle in the scene"
            if robot is not None and robot.ticks
            else "unknown: the robot never ran"
        )
    whose = f"of the tool's safety sphere (radius {summary.radius * 1e3:g} mm)"
    to = f" to {summary.nearest_obstacle!r}" if summary.nearest_obstacle else ""
    return f"{summary.min_clearance * 1e3:.1f} mm least (limit {summary.d_min * 1e3:g} mm), {whose}{to}"


def _targets(summary: RunSummary) -> str:
    if not summary.end_known:
        return NO_OPERATOR
    reached = f"{summary.targets_reached} of {summary.targets}"
    if not summary.duration:
        return f"{reached}; no motion was ever commanded"
    return f"{reached} in {summary.duration:.1f} s, counted from the first motion command as all times here"


def _round_trip(summary: RunSummary) -> str:
    if not summary.end_known:
        return NO_OPERATOR
    if summary.rtt_mean is None:
        return "never measured"
    computing = "computing" if summary.real_time else "modelled computing (--computing-time)"
    return f"{milliseconds(summary.rtt_mean)} ± {milliseconds(summary.rtt_std)} ms with {computing}"


def _arm(summary: RunSummary) -> str:
    if summary.min_arm_clearance is None:
        return ""
    part = f", {summary.nearest_part}" if summary.nearest_part else ""
    to = f" to {summary.nearest_to_arm!r}" if summary.nearest_to_arm else ""
    return f"{summary.min_arm_clearance * 1e3:.1f} mm least, of the bare arm without that sphere{part}{to}"


def _follows(summary: RunSummary) -> str:
    """Only where the robot follows otherwise than the scenario says: predictions are as good as its lag is."""
    operator = summary.counts.operator
    seen, said = (operator.lag if operator is not None else None), summary.lag
    if seen is None or said is None or abs(seen - said) <= max(LAG_OFF * said, LAG_NEAR):
        return ""
    return f"its commands with a lag of some {seen * 1e3:.0f} ms; robot.lag says {said * 1e3:g} ms"


def _lost(netem: NetemCounts | None) -> str:
    """`up 12 of 300 (loss 10, outage 2), down none of 3000`."""
    if netem is None:
        return "unknown: the emulator left no result"
    ways = [f"{label} {_lost_of(way)}" for label, way in (("up", netem.uplink), ("down", netem.downlink))]
    if netem.overflowed or netem.send_errors:
        ways.append(f"in the emulator itself {netem.overflowed + netem.send_errors}")
    if netem.changes:
        times = "once" if netem.changes == 1 else f"{netem.changes} times"
        ways.append(f"while the network was changed {times}")
    return ", ".join(ways)


def _lost_of(way: DirectionCounts) -> str:
    lost = sum(way.dropped.values())
    total = way.received + way.duplicated
    return f"{lost} of {total} ({count_reasons(way.dropped.items())})" if lost else f"none of {total}"


def _silence(summary: RunSummary) -> str:
    """The longest times in which nothing came."""
    operator, robot = summary.counts.operator, summary.counts.robot
    found = []
    if operator is not None and operator.states:
        found.append(f"{operator.longest_silence:.2f} s without a state at the operator")
    if robot is not None and robot.commands_received:
        found.append(f"{robot.longest_silence:.2f} s without a command at the robot")
    return f"longest: {', '.join(found)}" if found else ""


def _filter(summary: RunSummary) -> str:
    if not summary.end_known:
        return NO_OPERATOR
    plans = f"no plan found in {summary.infeasible} of them" if summary.infeasible else "always with a plan"
    changed = f"intervened in {summary.interventions} of {summary.ticks} ticks"
    return f"{changed}, {plans}; {summary.controller}, solver {summary.solver}"


def _guard(summary: RunSummary) -> str:
    """What the guard on the robot did."""
    robot = summary.counts.robot
    return guard_summary(robot, summary.guard_pairs) if robot is not None else ""


def _stops(summary: RunSummary) -> str:
    """How many, when (since the first motion command) and why; who acknowledged, if nobody did by hand."""
    if not summary.safety_known:
        return NO_ROBOT
    latched = [(t, reason) for t, mode, reason in summary.interruptions if mode in ("stopped", "estop")]
    told = [f"at {t:.1f} s {reason}" for t, reason in latched[:SHOWN_STOPS]]
    if len(latched) > SHOWN_STOPS:
        told.append(f"and {len(latched) - SHOWN_STOPS} more")
    if summary.stops and summary.acknowledges_itself:
        told.append("the steering device acknowledges stops itself")
    holds = summary.counts.robot.holds if summary.counts.robot is not None else 0
    more = f", {holds} hold{'s' if holds > 1 else ''} for want of commands" if holds else ""
    return f"{summary.stops}{more}" + (f": {'; '.join(told)}" if told else "")


def _stood(summary: RunSummary) -> str:
    """For how long there was no progress, by what held the robot."""
    standing = summary.counts.operator.standing if summary.counts.operator is not None else {}
    return ", ".join(
        f"{n * summary.period:.1f} s without progress: held by {what}" for what, n in sorted(standing.items())
    )


def _drawn_against_achieved(netem: NetemCounts | None) -> str:
    """`up 52.1 drawn, 52.2 achieved; down ...` in ms, from the emulator's statistics."""
    if netem is None:
        return ""
    return "; ".join(
        f"{label} {way.drawn.mean * 1e3:.2f} ms drawn, {way.achieved.mean * 1e3:.2f} ms achieved"
        for label, way in (("up", netem.uplink), ("down", netem.downlink))
    )
