"""One pill and one sentence: what the robot does, and why it does not do what was asked; with what clears it."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from msgspec import UNSET

from farhand.common.geometry import norm
from farhand.common.messages.intervention import Intervention
from farhand.common.messages.report import ControlReport
from farhand.common.messages.state import RobotState
from farhand.operator_side.console.following import Shortfall
from farhand.operator_side.console.sight import GONE_AFTER

LOST_AFTER = 1.0
"""Without news for so long nobody drives (s)."""
LATE_AFTER = 0.5
"""Without news for so long it is not known what the robot does (s); the worst stalls of 5G are as long."""
LESS = 0.9
"""Share of the asked speed, along what was asked, under which it counts as slowed."""
NOT_ENGAGED = "device not engaged"
"""What the operator's program says of a hand that it does not hear."""
FAR = 2.0
"""Times what is kept: from there on it is not plain why something is near."""
TAKEN_WITHIN = 0.25
"""From a press to the report that knows of it (s): two ticks of the slowest operator's program, and the way."""
STILL = 1e-3
"""m/s"""
LEAST_PART = 5e-4
"""Of a margin, which is told in whole millimetres (m)."""

_ACKNOWLEDGE = "Who drives acknowledges it, and presses anew."
_PAGES = "Pages are numbered as they are opened, since the console began."
_OUTAGE = "The outage that was asked for ends by itself. "

Pill = Literal["ready", "watching", "run", "held", "slowed", "stopped", "e-stop", "link lost", "taken"]


@dataclass(frozen=True, slots=True)
class Reason:
    """Attributes:
    pill: the word for it.
    what: in one sentence.
    clears: what clears it; empty: nothing needs to.
    """

    pill: Pill
    what: str
    clears: str = ""


@dataclass(frozen=True, slots=True)
class Situation:
    """Attributes:
    report, state: newest; None: none came.
    report_age, state_age: since they came (s).
    driver: name of the page that drives; empty: none does.
    watches: whether the page that is told of it is another one.
    you: name of the page that is told of it.
    asks: name of a page that asks for control; empty: none does.
    holds: whether the driver holds something down.
    stopping: whether an emergency stop was asked for that the robot has not latched yet.
    outage: whether an outage of the emulated network runs.
    frozen: for how long the camera has shown nothing new (s); 0: it does, or there is none.
    was_lost: for how long there had been no news, until a moment ago (s); 0: nothing of the kind.
    near: from the sphere around the tool to what binds (m); None: not known, or nothing binds.
    stopped_by: the page on which the emergency stop was asked for; empty: on none.
    held_for: since when the driver holds what it holds (s).
    short: what the robot's own speed lacks of what was sent; None: nothing.
    """

    report: ControlReport | None
    state: RobotState | None
    report_age: float
    state_age: float
    driver: str = ""
    watches: bool = False
    you: str = ""
    asks: str = ""
    holds: bool = False
    stopping: bool = False
    outage: bool = False
    frozen: float = 0.0
    was_lost: float = 0.0
    near: float | None = None
    stopped_by: str = ""
    held_for: float = 1e9
    short: Shortfall | None = None


def reasons(now: Situation) -> list[Reason]:
    """All that there is to say, what matters most first; never empty."""
    found = [*_lost(now), *_late(now), *_stopped(now)]
    return found + ([*_changed(now), *_waiting(now)] or ([] if found else [Reason("run", "As asked.")]))


def lost(now: Situation) -> str:
    """Why nobody may drive; empty where nothing is in the way."""
    return next((reason.what for reason in _lost(now)), "")


def unheard(now: Situation) -> bool:
    """Whether there is no news from the robot, or none of the operator's program."""
    return now.report is None or now.state is None or max(now.report_age, now.state_age) > LOST_AFTER


def _lost(now: Situation) -> Iterator[Reason]:
    if now.report is None:
        yield Reason(
            "link lost", "Waiting for the operator's program.", "It is found by itself once it runs."
        )
    elif now.report_age > LOST_AFTER:
        yield Reason(
            "link lost",
            f"Silent for {now.report_age:.1f} s: the operator's program. Driving is locked.",
            "Start it again; this page finds it by itself, and a new press drives on.",
        )
    elif now.state is None:
        yield Reason(
            "link lost", "Nothing has come from the robot yet.", "It is heard by itself once it runs."
        )
    elif now.state_age > LOST_AFTER:
        yield Reason(
            "link lost",
            f"{_no_news(now.state, now.state_age)}. Driving is locked.",
            f"{_OUTAGE if now.outage else ''}It unlocks by itself when the robot is heard again; then press anew.",
        )
    if now.frozen:
        yield Reason(
            "held",
            f"The camera shows nothing new for {now.frozen:.1f} s. Driving is locked.",
            f"It unlocks with the next picture, or without a camera after {GONE_AFTER:g} s; then press anew.",
        )


def _late(now: Situation) -> Iterator[Reason]:
    """What is not known any more, before anything is locked."""
    if lost(now):
        return
    state_late = _no_news(now.state, now.state_age) if now.state is not None else ""
    of_program = f"Nothing from the operator's program for {now.report_age:.1f} s"
    for age, what in ((now.report_age, of_program), (now.state_age, state_late)):
        if age > LATE_AFTER:
            yield Reason(
                "link lost",
                f"{what}: what the robot does now is not known.",
                f"{_OUTAGE if now.outage else ''}Driving locks after {LOST_AFTER:g} s.",
            )


def _no_news(state: RobotState, age: float) -> str:
    """Of whom there is no news: of the robot's program, or it is heard and has none itself, and says why."""
    if age - state.sample_age > LATE_AFTER:
        return f"No news from the robot for {age:.1f} s"
    return f"The robot's program has no news of the arm for {age:.1f} s ({state.reason})"


def _stopped(now: Situation) -> Iterator[Reason]:
    state = now.state
    if now.stopping:
        yield Reason(
            "e-stop",
            "Emergency stop asked for; the robot has not confirmed it yet.",
            "The operator's program sends it until the robot has latched it.",
        )
    if state is None:
        return
    if state.mode == "estop":
        by = "this page" if now.stopped_by == now.you else now.stopped_by
        # of the first of several, or of one with more to it, the place is not that of what is named last
        where = f", on {by}" if by and not any(more in state.reason for more in (", and by ", "; ")) else ""
        yield Reason("e-stop", f"{_again(now)}Latched by the robot: {state.reason}{where}.", _ACKNOWLEDGE)
    elif state.mode == "stopped":
        yield Reason(
            "stopped", f"{_again(now)}Latched by the robot: {state.reason}{_aside(state)}.", _ACKNOWLEDGE
        )
    if now.report is not None and "holds control" in now.report.stop_reason:
        yield Reason("taken", f"{now.report.stop_reason}.", "Its holder hands over, or gives control up.")


def _aside(state: RobotState) -> str:
    """What the robot's guard still does, or may do, in a stop that silence brought."""
    guard = state.guard
    if not guard:
        return "; its guard may take it out of the way of what moves" if state.evades else ""
    if guard.what == "evading":
        return f"; its guard takes the {guard.part} out of the way of {guard.obstacle}"
    return f"; its guard acts: {_by_guard(guard)}"


def _by_guard(guard: Intervention) -> str:
    """What it does, of which part, how near to what."""
    of = f" from {guard.obstacle}" if guard.obstacle else ""
    return f"{guard.what}: {guard.part} {_mm(guard.distance)} mm{of}"


def _changed(now: Situation) -> Iterator[Reason]:
    """What is done other than asked."""
    report, state = now.report, now.state
    if report is None or state is None or not now.holds:
        if state is not None and state.guard and state.mode not in ("stopped", "estop") and not lost(now):
            idle = "Nobody drives it; the" if state.mode == "hold" else "The"
            yield Reason(
                "slowed", f"{idle} robot's guard acts: {_by_guard(state.guard)}.", "It ends by itself."
            )
        return
    if state.guard:
        told = _by_guard(state.guard)
        yield Reason(
            "slowed",
            f"{told[:1].upper()}{told[1:]}; limit {_mm(state.guard.limit)}, by the robot's guard.",
            "Move away from it, or along it.",
        )
    asked, done = norm(report.desired), norm(report.filtered)
    if report.intervening and asked > STILL and _along(report) < LESS * asked:
        word = "Held" if done < STILL else "Slowed" if done < LESS * asked else "Turned aside"
        yield Reason(
            "held" if done < STILL else "slowed",
            f"{word}{_near(now, report)}{_early(now, report)}; {_kept(report)}.",
            f"The way is free to the {report.free_side}."
            if report.free_side
            else "Move away from it, or along it.",
        )
    if not state.guard:  # what the guard does the robot does on purpose
        yield from _not_followed(now, state)
    on_the_way = not report.intervening and now.short is None
    if on_the_way and asked > STILL and report.mode == "run" and _along(report) < LESS * asked:
        yield Reason("run", f"On the way to what was asked: {done:.2f} of {asked:.2f} m/s.")
    turns, turned = norm(report.desired_angular), norm(report.angular)
    if turns > STILL and report.mode == "run" and turned < LESS * turns:
        yield Reason(
            "slowed",
            f"Turned at {turned:.2f} of {turns:.2f} rad/s, the most that is let.",
            "Turn more slowly.",
        )
    yield from _not_taken(now, report)
    if report.held_by:
        yield Reason("held", f"No progress: held by {report.held_by}.", "Drive or turn another way.")


def _not_taken(now: Situation, report: ControlReport) -> Iterator[Reason]:
    """Why the operator's program does not take what is held."""
    if report.stop_reason == NOT_ENGAGED and now.held_for < TAKEN_WITHIN:
        yield Reason("run", "Pressed; the operator's program has not said yet that it takes it.")
    elif report.stop_reason == NOT_ENGAGED:
        yield Reason("held", "Let go by itself: the hand was not heard for a moment.", "Press anew.")
    elif report.stop_reason and report.mode != "run":
        what = f"{report.stop_reason[:1].upper()}{report.stop_reason[1:]}."
        yield Reason("held", what, "It goes on by itself once that is over.")


def _not_followed(now: Situation, state: RobotState) -> Iterator[Reason]:
    """What the robot does not do of what was sent, by its own measure."""
    short = now.short
    if short is None:
        return
    speed = f"{max(0.0, short.done):.2f} of {short.sent:.2f} {short.unit}"
    if not short.lasting:
        yield Reason("run", f"On the way: the robot does {speed} so far.")
        return
    held_by = "" if state.held_by is UNSET else state.held_by
    why = held_by or (state.reason if state.mode == "hold" else "") or "not known yet why"
    if short.stands:
        yield Reason("held", f"Standing: the robot does not follow: {why}.", "Drive or turn another way.")
    else:
        yield Reason("slowed", f"The robot follows with {speed}: {why}.", "Drive or turn another way.")


def _waiting(now: Situation) -> Iterator[Reason]:
    if now.holds or now.state is None or now.stopping or lost(now) or now.state.mode in ("estop", "stopped"):
        return
    if now.was_lost:
        watches = now.watches and bool(now.driver)
        who = f"{now.driver} presses" if watches else "you press"
        yield Reason("watching" if watches else "ready", f"{_again(now)}Nothing is driven until {who} anew.")
    if not now.driver:
        yield Reason("ready", "Nobody drives. Take control to begin.", "Take control.")
    elif now.watches:
        you = f" on {now.you}" if now.you else ""
        yield Reason(
            "watching",
            f"{now.driver.capitalize()} drives, you watch{you}.",
            f"Ask for control, to drive. {_PAGES}",
        )
    elif now.asks:
        yield Reason(
            "ready", f"{now.asks.capitalize()} asks for control.", f"Hand over, or drive on. {_PAGES}"
        )
    else:
        yield Reason("ready", "Hold a key or a button to move; let go to stop.")


def _again(now: Situation) -> str:
    """That there is news again, where there was none until a moment ago."""
    return f"Connected again after {now.was_lost:.1f} s. " if now.was_lost and not unheard(now) else ""


def _along(report: ControlReport) -> float:
    """The speed that is left in the direction that was asked for (m/s)."""
    asked = norm(report.desired)
    return sum(a * b for a, b in zip(report.desired, report.filtered, strict=True)) / asked


def _near(now: Situation, report: ControlReport) -> str:
    """What is how near to what; the robot's clearance is told where it is not known what binds."""
    if not report.binding:
        return (
            "" if report.clearance is None else f": tool {_mm(report.clearance)} mm from the nearest obstacle"
        )
    return f" by {report.binding}" if now.near is None else f": tool {_mm(now.near)} mm from {report.binding}"


def _early(now: Situation, report: ControlReport) -> str:
    """Why something far off is near: the speed towards it is limited by the way that is left."""
    kept = report.inflation + report.sigma + (0.0 if report.limit is UNSET else report.limit)
    return ", the nearer the slower" if now.near is not None and now.near > FAR * kept else ""


def _kept(report: ControlReport) -> str:
    """What is kept between the two: the limit, the margin beyond it, and how much of that is the network's doing."""
    margin = report.inflation + report.sigma
    limit = "" if report.limit is UNSET else f"limit {_mm(report.limit)}, "
    network = margin - sum(report.margin_parts.get(name, 0.0) for name in ("floor", "lag"))
    of = f", of which network {_mm(network)}" if _from_network(report) and network >= LEAST_PART else ""
    return f"{limit}margin {_mm(margin)}{of}"


def _from_network(report: ControlReport) -> bool:
    """Whether the margin's law says what of it is for the network: what is above its floor, but for the lag's part."""
    return "floor" in report.margin_parts and (
        "innovation" in report.margin_parts or "spread" in report.margin_parts
    )


def _mm(metres: float) -> str:
    return f"{metres * 1e3:.0f}"
