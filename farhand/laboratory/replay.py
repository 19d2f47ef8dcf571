"""Feeds a recorded run through the operator's node again: the same decisions to the byte, or another
controller's on the same input.

What another controller would have decided is asked tick by tick: every tick begins from the commands that
the robot really got, as its recorded answers follow from those.
"""

from dataclasses import dataclass
from pathlib import Path

import msgspec

from farhand.common.errors import RunFileError
from farhand.common.geometry import norm
from farhand.common.link.link import Packet
from farhand.common.messages.base import Vector3
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.report import ControlReport
from farhand.common.recording.place import recording_at
from farhand.common.recording.reader import RecordedRun, read_run
from farhand.common.recording.records import TickRecord
from farhand.laboratory.replay_scenario import scenario_of
from farhand.operator_side.control.controller import Controller
from farhand.operator_side.control.registry import make_controller
from farhand.operator_side.operator_node import OperatorIdentity
from farhand.operator_side.prepare import prepare
from farhand.operator_side.steering.device import SteeringDevice, SteeringInput, View
from farhand.operator_side.supervision import ESTOP_ASKED
from farhand.programs.wiring import make_operator, versions
from farhand.runs.scenario import Scenario


class RecordedLink:
    """Hands over what was recorded for the tick, keeps what is sent."""

    def __init__(self) -> None:
        self.waiting: list[Packet] = []
        self.sent: bytes | None = None

    def send(self, packet: Packet) -> None:
        """See Link."""
        self.sent = packet.payload

    def receive(self) -> list[Packet]:
        """See Link."""
        packets, self.waiting = self.waiting, []
        return packets


class RecordedSteering(SteeringDevice):
    """Wants what was wanted in the run, whatever device it was that steered."""

    def __init__(self) -> None:
        super().__init__()
        self.report: ControlReport | None = None

    def read(self, view: View) -> SteeringInput:
        """See SteeringDevice."""
        if self.report is None:
            return SteeringInput()
        report, mode = self.report, self.report.mode
        robot = f"robot {report.safety}: {report.safety_reason}; "
        return SteeringInput(
            self.report.desired,
            engaged=mode == "run",
            acknowledge=mode == "acknowledge",
            estop=mode == "estop" and report.stop_reason != ESTOP_ASKED,
            says=report.stop_reason.removeprefix(robot) if report.stop_reason.startswith(robot) else "",
            angular=self.report.desired_angular,
        )


@dataclass(frozen=True)
class ReplayedTick:
    """Attributes:
    number: counts the run's ticks from 0.
    now_ns: beginning of the tick, operator's clock.
    recorded, decided: the report of then and of now.
    identical: command and report are the same to the byte.
    """

    number: int
    now_ns: int
    recorded: ControlReport
    decided: ControlReport
    identical: bool

    @property
    def difference(self) -> float:
        """Of the two velocities (m/s)."""
        pairs = zip(self.recorded.filtered, self.decided.filtered, strict=True)
        return norm(a - b for a, b in pairs)


@dataclass(frozen=True)
class Replay:
    """Attributes:
    run: as recorded.
    scenario: with the replacements.
    changed: whether anything was replaced.
    ticks: in order.
    """

    run: RecordedRun
    scenario: Scenario
    changed: bool
    ticks: list[ReplayedTick]

    @property
    def judged(self) -> list[ReplayedTick]:
        """The ticks before the first gap of the recording: what was decided after it follows from ticks that
        are not there."""
        return self.ticks[: self.run.whole_ticks]

    @property
    def unjudged(self) -> int:
        """How many ticks cannot be judged: those after the first gap, and those that are missing for certain."""
        return len(self.ticks) - len(self.judged) + self.run.missing

    @property
    def identical(self) -> bool:
        """Whether every decision that can be judged is."""
        return all(tick.identical for tick in self.judged)

    @property
    def first_difference(self) -> ReplayedTick | None:
        """The first judged tick that is not identical."""
        return next((tick for tick in self.judged if not tick.identical), None)

    def other_versions(self) -> dict[str, tuple[str, str]]:
        """What was installed then and is another version now."""
        now = versions()
        then = self.run.info.versions
        return {name: (then[name], now.get(name, "absent")) for name in then if then[name] != now.get(name)}


def replay(
    path: Path, settings: dict[str, object] | None = None, controller: Controller | None = None
) -> Replay:
    """Run a recording through the operator's node.

    Args:
        path: a run's folder or its file.
        settings: replacements by dotted key, of the deciding side only.
        controller: in place of the scenario's.

    Raises:
        InputError: the file is not readable at all, or a setting makes no sense in a replay.
    """
    run = read_run(recording_at(path))
    scenario = scenario_of(run, path, settings or {})
    changed = bool(settings) or controller is not None
    link, steering = RecordedLink(), RecordedSteering()
    reports, commands = Decoder(ControlReport), Decoder(VelocityCommand)
    if controller is None:
        controller = make_controller(scenario.controller)
    prepare(controller)
    readings: list[float] = []
    node = make_operator(
        scenario,
        link,
        OperatorIdentity(run.info.robot, run.info.session, run.info.operator),
        controller,
        lambda: readings.pop(),
        steering,
    )
    ticks = []
    for record in run.ticks:
        recorded = reports.decode(record.report)
        if recorded is None:
            raise RunFileError(f"run {path}: tick {record.number}: unreadable report: {reports.last_refusal}")
        readings[:] = [recorded.solve_time, 0.0]  # the stopwatch reads as it did then
        steering.report = recorded
        command = None if record.command is None else commands.decode(record.command)
        if command is not None and command.successor:
            node.hand_over(command.successor)
        if recorded.stop_reason == ESTOP_ASKED:
            node.emergency_stop()
        link.waiting, link.sent = _packets(record), None
        node.step(record.now_ns)
        if node.report is None:
            raise RunFileError(
                f"run {path}: tick {record.number}: its instants are not those of a control loop"
            )
        same = link.sent == record.command and encode(node.report) == record.report
        ticks.append(ReplayedTick(record.number, record.now_ns, recorded, node.report, same))
        if changed and command is not None:
            node.correct(command)
    return Replay(run, scenario, changed, ticks)


def _packets(record: TickRecord) -> list[Packet]:
    return [Packet(key, payload, arrived_ns) for key, arrived_ns, payload in record.packets]


def differing_fields(tick: ReplayedTick) -> list[str]:
    """Names of the report's fields that differ."""
    names = tick.recorded.__struct_fields__
    return [n for n in names if getattr(tick.recorded, n) != getattr(tick.decided, n)]


def side_by_side(result: Replay) -> list[tuple[str, str, str]]:
    """What was decided then and now: name, recorded, decided."""
    then = [tick.recorded for tick in result.ticks]
    now = [tick.decided for tick in result.ticks]
    return [(name, _of(then, name), _of(now, name)) for name in MEASURES]


MEASURES = (
    "ticks that intervene",
    "ticks without a plan that meets all",
    "mean commanded speed (m/s)",
    "largest margin (m)",
    "mean margin (m)",
)


def _of(reports: list[ControlReport], measure: str) -> str:
    running = [r for r in reports if r.mode == "run"]
    if measure.startswith("ticks that"):
        return str(sum(r.intervening for r in reports))
    if measure.startswith("ticks without"):
        return str(sum(r.status not in ("optimal", "shortcut", "idle") for r in reports))
    values = [_value(r, measure) for r in running]
    if not values:
        return "–"
    return f"{max(values) if measure.startswith('largest') else sum(values) / len(values):.4f}"


def _value(report: ControlReport, measure: str) -> float:
    if "margin" in measure:
        return (
            report.inflation + report.sigma
        )  # whether a law widens obstacles or the barrier, as in the report
    return norm(report.filtered)


def to_csv(result: Replay) -> str:
    """A line a tick: what was decided then and now."""
    axes = "xyz"
    names = ["time [s]", "mode", *(f"desired_{a} [m/s]" for a in axes)]
    for who in ("recorded", "decided"):
        names += [*(f"{who}_{a} [m/s]" for a in axes), f"{who}_sigma [m]", f"{who}_inflation [m]"]
        names += [f"{who}_status", f"{who}_binding"]
    lines = [",".join(names)]
    origin_ns = result.ticks[0].now_ns if result.ticks else 0
    for tick in result.ticks:
        cells = [repr((tick.now_ns - origin_ns) * 1e-9), tick.recorded.mode, *_floats(tick.recorded.desired)]
        for report in (tick.recorded, tick.decided):
            cells += [*_floats(report.filtered), repr(report.sigma), repr(report.inflation)]
            cells += [report.status, report.binding]
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


def _floats(vector: Vector3) -> list[str]:
    return [repr(value) for value in vector]


def to_json(result: Replay) -> str:
    """One line of JSON for programs."""
    first = result.first_difference
    return msgspec.json.encode(
        {
            "ticks": len(result.ticks),
            "judged": len(result.judged),
            "identical": sum(tick.identical for tick in result.judged),
            "unjudged": result.unjudged,
            "complete": result.run.complete,
            "missing": result.run.missing,
            "flaws": result.run.flaws(),
            "changed": result.changed,
            "largest_difference": max((tick.difference for tick in result.ticks), default=0.0),
            "first_difference_ns": None if first is None else first.now_ns,
            "side_by_side": {name: [then, now] for name, then, now in side_by_side(result)},
            "other_versions": result.other_versions(),
        }
    ).decode()
