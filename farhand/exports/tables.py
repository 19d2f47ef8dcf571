"""The tables of a run: which columns there are, in which unit, and what is in them."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import msgspec

from farhand.common.messages.base import Quaternion, Vector3
from farhand.common.messages.keys import kind_of
from farhand.common.messages.report import ControlReport
from farhand.common.messages.state import RobotState
from farhand.common.recording.decoded import DecodedTick
from farhand.common.recording.fates import Fate
from farhand.exports.source import Source
from farhand.foxglove.happenings import Happening

Kind = Literal["int", "float", "bool", "text"]
Row = dict[str, Any]
NS = 1e-9


@dataclass(frozen=True, slots=True)
class Column:
    """Attributes:
    name: its name.
    kind: of its values; each may be missing.
    unit: SI, or empty.
    meaning: in words.
    """

    name: str
    kind: Kind
    unit: str
    meaning: str


def _xyz(name: str, unit: str, meaning: str) -> list[Column]:
    return [Column(f"{name}_{axis}", "float", unit, f"{meaning}, {axis}") for axis in "xyz"]


def _wxyz(name: str, meaning: str) -> list[Column]:
    return [
        Column(f"{name}_q{axis}", "float", "", f"{meaning}, {axis} of a unit quaternion") for axis in "wxyz"
    ]


_RUN = Column("run", "text", "", "name of the run")
_TIME = Column("time", "float", "s", "since the run's first tick in the recording, operator's clock")

RUNS = (
    _RUN,
    Column("file", "text", "", "the recording"),
    Column("scenario", "text", "", "its name"),
    Column("robot", "text", "", "its name"),
    Column("operator", "text", "", "its name"),
    Column("seed", "int", "", "of the run"),
    Column("clock", "text", "", "`real` or `virtual`"),
    Column("start_ns", "int", "ns", "first tick, operator's clock: where `time` is 0"),
    Column(
        "epoch_ns",
        "int",
        "ns",
        "added to the operator's clock it is the time of day since 1970; 0: virtual time",
    ),
    Column("solver", "text", "", "the controller's"),
    Column("git", "text", "", "the source that ran, as `git describe` says"),
    Column("ticks", "int", "", "in the recording"),
    Column("notes", "text", "", "what is missing, in words; empty: nothing"),
)
TICKS = (
    _RUN,
    Column("tick", "int", "", "number, from 0"),
    _TIME,
    Column("now_ns", "int", "ns", "beginning of the tick, operator's clock"),
    Column("seq", "int", "", "number of the command that was sent; missing: none was"),
    Column("mode", "text", "", "of the command: run, hold, estop, acknowledge, release"),
    *_xyz("asked", "m/s", "velocity that the operator asked for"),
    *_xyz("asked_angular", "rad/s", "angular velocity that the operator asked for"),
    *_xyz("filtered", "m/s", "velocity after the filter, as sent"),
    *_xyz("filtered_angular", "rad/s", "angular velocity after its limits, as sent"),
    *_xyz("tool", "m", "position of the tool as last reported, base frame"),
    *_wxyz("tool", "orientation of the tool as last reported"),
    *_xyz("predicted", "m", "position from which the controller planned"),
    *_wxyz("predicted", "orientation there"),
    Column("intervening", "bool", "", "whether the filter has a hand in the command"),
    Column("binding", "text", "", "obstacle that binds"),
    Column("clearance", "float", "m", "of the tool's sphere to the nearest obstacle, as reported"),
    Column("min_clearance", "float", "m", "smallest so far, as reported"),
    Column("margin", "float", "m", "inflation of the nearest obstacle"),
    Column("margin_parts", "text", "m", "named parts of it, as JSON"),
    Column("sigma", "float", "m", "the paper's margin added to the barrier"),
    Column("prediction_error", "float", "m", "newest innovation"),
    Column("rtt", "float", "s", "newest round trip"),
    Column("rtt_mean", "float", "s", "over the window"),
    Column("rtt_std", "float", "s", "over the window"),
    Column("loss", "float", "", "fraction of commands or states known to be lost"),
    Column("age", "float", "s", "of the oldest unanswered command"),
    Column("state_age", "float", "s", "since the newest state arrived"),
    Column("status", "text", "", "the solver's"),
    Column("solve_time", "float", "s", "of the solver"),
    Column("safety", "text", "", "the robot's watchdog: run, hold, stopped, estop"),
    Column("safety_reason", "text", "", "why"),
    Column("stop_reason", "text", "", "why the operator's side commands zero; empty: it does not"),
    Column("held_by", "text", "", "what holds a robot without progress"),
    Column("blocked_by", "text", "", "obstacle in the way that is wanted"),
    Column("free_side", "text", "", "side on which the way round it is free"),
    Column("guard", "text", "", "what the guard on the robot did: slowed, turned, evading, ..."),
    Column("guard_part", "text", "", "to which part of the robot"),
    Column("guard_obstacle", "text", "", "for which obstacle"),
    Column("guard_distance", "float", "m", "between the two"),
    Column("target_index", "int", "", "of the target in force"),
    Column("target_count", "int", "", "of targets"),
    Column("refused_here", "int", "", "messages refused by the operator's side so far"),
    Column("refused_there", "int", "", "commands refused by the robot so far"),
    Column("stops", "int", "", "of the robot so far"),
    Column("states", "int", "", "arrived so far"),
    Column("state_rate", "float", "Hz", "states arriving"),
    Column("overruns", "int", "", "late ticks so far"),
    Column("connected", "bool", "", "whether the operator's program is connected to the robot's side"),
)
MESSAGES = (
    _RUN,
    Column("direction", "text", "", "uplink (to the robot) or downlink"),
    Column("kind", "text", "", "command, state, scene, description, ..."),
    Column("key", "text", "", "its Zenoh key"),
    Column("number", "int", "", "messages of its key before it"),
    Column("copy", "bool", "", "whether the network made it of another one"),
    Column("size", "int", "byte", "of its payload"),
    Column("arrived", "float", "s", "at the emulator, since its first message of any key"),
    Column("drawn", "float", "s", "delay that the delay's word drew"),
    Column("assigned", "float", "s", "delay that the whole network assigned"),
    Column("achieved", "float", "s", "delay that it had; missing: lost"),
    Column("corrupted_bit", "int", "", "the bit of its payload that was flipped; missing: none"),
    Column("fate", "text", "", "delivered, `on the way` at the end of the run, or the word that lost it"),
)
HAPPENINGS = (
    _RUN,
    Column("kind", "text", "", "filter, guard, stop, refused, held"),
    Column("began", "float", "s", "since the run's first tick in the recording"),
    Column("ended", "float", "s", "when it was last so"),
    Column("words", "text", "", "what happened"),
    Column("facts", "text", "", "numbers and names, as JSON"),
)


def states(joints: int) -> tuple[Column, ...]:
    """The columns of states of a robot with so many joints."""
    return (
        _RUN,
        Column("tick", "int", "", "tick that began after it arrived"),
        Column(
            "time", "float", "s", "its arrival since the run's first tick in the recording, operator's clock"
        ),
        Column("arrived_ns", "int", "ns", "its arrival, operator's clock"),
        Column("sampled_ns", "int", "ns", "when it was sampled, robot's clock"),
        Column("session", "int", "", "of the robot's program"),
        Column("seq", "int", "", "its number"),
        *_xyz("tool", "m", "position of the tool, base frame"),
        *_wxyz("tool", "orientation of the tool"),
        *_xyz("velocity", "m/s", "of the tool"),
        *_xyz("angular", "rad/s", "angular velocity of the tool, base's axes"),
        *(Column(f"joint_{i}", "float", "rad", f"position of joint {i}") for i in range(joints)),
        Column("applied_session", "int", "", "session of the command that is applied; 0: none yet"),
        Column("applied_seq", "int", "", "number of the command that is applied"),
        Column("applied_for", "float", "s", "for how long it has been applied"),
        Column("mode", "text", "", "the watchdog's: run, hold, stopped, estop"),
        Column("reason", "text", "", "why"),
        Column("holder", "int", "", "session that holds control; 0: nobody"),
        Column("holder_name", "text", "", "its name"),
        Column("clearance", "float", "m", "true distance of the tool's sphere to the nearest obstacle"),
        Column("min_clearance", "float", "m", "smallest so far"),
        Column("arm_clearance", "float", "m", "of the whole arm; missing: not computed"),
        Column("refused", "text", "", "commands refused so far by reason, as JSON"),
        Column("received", "int", "", "command messages that arrived so far"),
        Column("stops", "int", "", "so far"),
        Column("held_by", "text", "", "what keeps the robot from following"),
        Column("guard", "text", "", "what the guard did since the state before"),
        Column("evades", "bool", "", "whether the guard may still move it though it is stopped"),
    )


def tables(joints: int) -> dict[str, tuple[Column, ...]]:
    """All tables, by name."""
    return {
        "runs": RUNS,
        "ticks": TICKS,
        "states": states(joints),
        "messages": MESSAGES,
        "happenings": HAPPENINGS,
    }


def run_row(source: Source, start_ns: int) -> Row:
    """Of `runs`."""
    info = source.info
    return {
        "run": source.run.name,
        "file": source.run.path.name,
        "scenario": str(info.scenario.get("name", "")),
        "robot": info.robot,
        "operator": info.operator,
        "seed": info.seed,
        "clock": info.clock,
        "start_ns": start_ns,
        "epoch_ns": info.epoch_ns,
        "solver": info.solver,
        "git": info.git,
        "ticks": source.ticks,
        "notes": "; ".join(source.notes),
    }


def tick_row(run: str, tick: DecodedTick, start_ns: int) -> Row:
    """Of `ticks`."""
    record = tick.record
    row: Row = {
        "run": run,
        "tick": record.number,
        "time": (record.now_ns - start_ns) * NS,
        "now_ns": record.now_ns,
        "seq": None if tick.command is None else tick.command.seq,
    }
    if tick.report is not None:
        row |= _report(tick.report)
    return row


def _report(report: ControlReport) -> Row:
    row: Row = {name: getattr(report, name) for name in _PLAIN}
    row |= _vector("asked", report.desired) | _vector("asked_angular", report.desired_angular)
    row |= _vector("filtered", report.filtered) | _vector("filtered_angular", report.angular)
    if report.states:  # before the first one nobody knows where the tool is
        row |= _vector("tool", report.position) | _quaternion("tool", report.orientation)
        row |= _vector("predicted", report.predicted)
        row |= _quaternion("predicted", report.predicted_orientation)
    row["margin"] = report.inflation
    row["margin_parts"] = _json(report.margin_parts)
    did = report.guard
    if did is not None:
        row |= {"guard": did.what, "guard_part": did.part, "guard_obstacle": did.obstacle}
        row["guard_distance"] = did.distance
    return row


_PLAIN = tuple(
    column.name
    for column in TICKS
    if column.name in ControlReport.__struct_fields__ and column.name != "guard"
)


def state_row(run: str, tick: int, arrived_ns: int, state: RobotState, start_ns: int) -> Row:
    """Of `states`."""
    row: Row = {
        "run": run,
        "tick": tick,
        "time": (arrived_ns - start_ns) * NS,
        "arrived_ns": arrived_ns,
        "sampled_ns": state.t_sample_ns,
        "applied_for": state.applied_for_ns * NS,
        "refused": _json(state.refused),
        "held_by": "" if state.held_by is msgspec.UNSET else state.held_by,
        "guard": "" if state.guard is msgspec.UNSET else state.guard.what,
        "evades": state.evades is True,
    }
    row |= {name: getattr(state, name) for name in _STATE_PLAIN}
    row |= _vector("tool", state.position) | _vector("velocity", state.velocity)
    row |= _vector("angular", state.angular_velocity)
    row |= _quaternion("tool", state.orientation)
    row |= {f"joint_{i}": position for i, position in enumerate(state.joints)}
    return row


_STATE_PLAIN = tuple(
    column.name
    for column in states(0)
    if column.name in RobotState.__struct_fields__
    and column.name not in ("refused", "held_by", "guard", "evades")
)


def message_row(run: str, fate: Fate) -> Row:
    """Of `messages`."""
    return {
        "run": run,
        "direction": fate.direction,
        "kind": kind_of(fate.key),
        "key": fate.key,
        "number": fate.number,
        "copy": fate.copy,
        "size": fate.size,
        "arrived": fate.arrived_ns * NS,
        "drawn": fate.drawn_ns * NS,
        "assigned": fate.assigned_ns * NS,
        "achieved": None if fate.achieved_ns < 0 else fate.achieved_ns * NS,
        "corrupted_bit": None if fate.corrupted < 0 else fate.corrupted,
        "fate": fate.fate,
    }


def happening_row(run: str, happening: Happening, start_ns: int) -> Row:
    """Of `happenings`."""
    return {
        "run": run,
        "kind": happening.kind,
        "began": (happening.began_ns - start_ns) * NS,
        "ended": (happening.seen_ns - start_ns) * NS,
        "words": happening.words,
        "facts": _json(happening.facts),
    }


def _vector(name: str, values: Vector3) -> Row:
    return dict(zip((f"{name}_{axis}" for axis in "xyz"), values, strict=True))


def _quaternion(name: str, values: Quaternion) -> Row:
    return dict(zip((f"{name}_q{axis}" for axis in "wxyz"), values, strict=True))


def _json(value: Mapping[str, Any]) -> str:
    return msgspec.json.encode(value).decode()
