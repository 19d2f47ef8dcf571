"""What a recording tells, read once from its start to its end: columns of numbers, and what happened."""

from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from farhand.common.geometry import norm
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Scene
from farhand.common.messages.state import RobotState
from farhand.common.recording.decoded import DecodedTick, TickDecoder
from farhand.common.recording.fates import FATE_TOPICS, Fate
from farhand.common.recording.reader import RunReader, read_in_order
from farhand.common.recording.records import Gap, RunInfo, TickRecord
from farhand.foxglove.happenings import Happening, Happenings
from farhand.report.reading.columns import Columns, NamedParts
from farhand.report.reading.deeds import Deeds
from farhand.report.reading.network import Network

TICK_COLUMNS = (
    "t",
    "number",
    "clearance",
    "inflation",
    "sigma",
    "asked",
    "done",
    "turn_asked",
    "turn_done",
    "rtt",
    "loss",
    "age",
    "state_age",
    "error",
    "solve",
    "driving",
    "intervening",
    "seen",
)
STATE_COLUMNS = ("t", "sample", "session", "seq", "x", "y", "z", "clearance", "arm", "late")
MOST_HAPPENINGS = 20_000


@dataclass
class Story:
    """A recorded run in numbers; times in s since its first motion command, on the operator's clock.

    Attributes:
        info: see RunInfo.
        began_ns: the first tick (operator's clock).
        zero_ns: the first motion command, else, where it is not recorded, the first tick: zero of all times here.
        zero: which of them, in words.
        drove: whether it is the first motion command.
        whole: every tick is there, as far as the recording alone can tell.
        ticks: columns TICK_COLUMNS, a row a tick: s, m, m/s, rad/s; `sigma` of the barrier; flags 0 and 1.
        parts: of the margin, a column each (m), a row a tick.
        states: columns STATE_COLUMNS, a row a state that arrived: t of its arrival, `sample` of its making on the
            robot's clock (s), its sender's session (counted from 0) and number, position (m), clearance of the tool's
            sphere and of the arm (m), whether a newer one had overtaken it (0, 1).
        happenings: what happened, in the order of its beginning.
        untold: happenings beyond those that are kept.
        scene, robot: the newest; None: never arrived.
        scene_changes: how often the obstacles were seen to be changed.
        had_obstacles: whether there ever were any.
        last: the newest report; None: there is none.
        least: smallest clearance that the robot told of, at its own rate (m); None: none did.
        network: what became of messages at the emulator.
        lacks: a line about each thing that is missing; empty: the recording is whole.
        size: bytes of the file.
    """

    info: RunInfo
    began_ns: int = 0
    zero_ns: int = 0
    zero: str = ""
    drove: bool = False
    whole: bool = True
    ticks: Columns = field(default_factory=lambda: Columns(*TICK_COLUMNS))
    parts: NamedParts = field(default_factory=NamedParts)
    states: Columns = field(default_factory=lambda: Columns(*STATE_COLUMNS))
    happenings: list[Happening] = field(default_factory=list)
    untold: int = 0
    scene: Scene | None = None
    scene_changes: int = 0
    had_obstacles: bool = False
    robot: RobotDescription | None = None
    last: ControlReport | None = None
    least: float | None = None
    network: Network = field(default_factory=Network)
    lacks: list[str] = field(default_factory=list)
    size: int = 0

    @property
    def driven(self) -> float | None:
        """From the first motion command to the last tick (s); None: it is not recorded."""
        return float(self.ticks["t"][-1]) if self.drove else None

    @property
    def length(self) -> float:
        """From the first tick to the last (s)."""
        t = self.ticks["t"]
        return float(t[-1] - t[0]) if len(t) else 0.0

    def since(self, instant_ns: int) -> float:
        """An instant of the operator's clock as s since `zero_ns`."""
        return (instant_ns - self.zero_ns) * 1e-9


def read_story(path: Path) -> Story:
    """Read a recording, whole or not; raises RunFileError where nothing of it can be read."""
    reader = RunReader(path)
    story = Story(reader.info, size=reader.size)
    _Reading(story).read(reader)
    return story


class _Reading:
    """Fills a story."""

    def __init__(self, story: Story) -> None:
        self._story = story
        self._decoder, self._fate = TickDecoder(), msgspec.json.Decoder(Fate).decode
        self._happenings, self._deeds = Happenings(), Deeds()
        self._sessions: dict[int, int] = {}
        self._unread = 0
        self._before: tuple[int, bool] = (-1, False)  # number of the tick before, and whether it drove
        self._first_drive: tuple[int, bool] | None = (
            None  # when one drove, and whether it is known to be the first
        )

    def read(self, reader: RunReader) -> None:
        """All of a file."""
        story, flaws = self._story, []
        for item in read_in_order(reader, set(FATE_TOPICS.values())):
            if isinstance(item, TickRecord):
                self._tick(self._decoder.decode(item))
            elif isinstance(item, Gap):
                flaws.append(self._missing(item))
            else:
                self._take_fate(item.data)
        for happening in self._happenings.end():
            self._keep(happening)
        story.happenings.sort(key=lambda each: (each.began_ns, each.kind))
        self._deeds.explain(story.happenings)
        missing = self._of_file(reader)
        story.whole = not (missing or flaws or self._unread)
        self._set_zero()
        story.lacks = [*missing, *_few(flaws), *self._of_content(reader)]

    def _tick(self, tick: DecodedTick) -> None:
        story, now_ns = self._story, tick.record.now_ns
        if not story.began_ns:
            story.began_ns = story.zero_ns = now_ns
        news = {id(message) for _, _, message in tick.news}
        for arrived_ns, _, message in tick.arrived:
            if isinstance(message, RobotState):
                self._state(message, arrived_ns, late=id(message) not in news)
            elif isinstance(message, Scene):
                self._scene(message, arrived_ns)
            elif isinstance(message, RobotDescription):
                story.robot = message
        report = tick.report
        if report is None:
            self._unread += 1
            return
        self._note_drive(tick.record.number, now_ns, drives=report.mode == "run")
        for happening in self._happenings.tick(report, now_ns):
            self._keep(happening)
        self._deeds.tick(report, now_ns)
        story.last = report
        story.parts.add(report.margin_parts)
        story.ticks.add(
            story.since(now_ns),
            tick.record.number,
            report.clearance,
            report.inflation,
            report.sigma,
            norm(report.desired),
            norm(report.filtered),
            norm(report.desired_angular),
            norm(report.angular),
            report.rtt,
            report.loss,
            report.age,
            report.state_age if report.states else None,
            report.prediction_error,
            report.solve_time,
            report.mode == "run",
            report.intervening,
            report.states > 0,
        )

    def _note_drive(self, number: int, now_ns: int, *, drives: bool) -> None:
        before, drove = self._before
        if drives and self._first_drive is None:
            self._first_drive = now_ns, number == before + 1 and not drove
        self._before = number, drives

    def _set_zero(self) -> None:
        """Count all times from the first motion command on, where it is known which that is."""
        story = self._story
        if self._first_drive is None:
            story.zero = "the first tick: no motion command is recorded"
        elif not self._first_drive[1]:
            story.zero = "the first tick that is recorded: the first motion command is not"
        else:
            story.zero, story.drove = "the first motion command", True
            story.zero_ns = self._first_drive[0]
            for columns in (story.ticks, story.states):
                columns.shift("t", (story.began_ns - story.zero_ns) * 1e-9)

    def _state(self, state: RobotState, arrived_ns: int, *, late: bool) -> None:
        story = self._story
        if not late:
            for happening in self._happenings.state(state, arrived_ns):
                self._keep(happening)
            self._deeds.state(state, arrived_ns)
        story.least = state.min_clearance if story.least is None else min(story.least, state.min_clearance)
        story.states.add(
            story.since(arrived_ns),
            state.t_sample_ns * 1e-9,
            self._sessions.setdefault(state.session, len(self._sessions)),
            state.seq,
            *state.position,
            state.clearance,
            state.arm_clearance,
            late,
        )

    def _scene(self, scene: Scene, arrived_ns: int) -> None:
        """The newest by its number."""
        story = self._story
        if scene.overtaken_by(story.scene):
            return
        for happening in self._happenings.scene(scene, arrived_ns):
            self._keep(happening)
            story.scene_changes += 1
        story.scene = scene
        story.had_obstacles = story.had_obstacles or bool(scene.obstacles)

    def _take_fate(self, data: bytes) -> None:
        try:
            self._story.network.add(self._fate(data))
        except (msgspec.MsgspecError, ValueError):
            self._story.network.unread += 1

    def _keep(self, happening: Happening) -> None:
        if len(self._story.happenings) < MOST_HAPPENINGS:
            self._story.happenings.append(happening)
        else:
            self._story.untold += 1

    def _missing(self, gap: Gap) -> str:
        after = self._story.since(gap.first_ns)
        return f"{gap.ticks} ticks are missing {max(0.0, after):.1f} s after the first one: {gap.why}"

    def _of_file(self, reader: RunReader) -> list[str]:
        lines = []
        if reader.cut_off:
            lines.append("the file is cut off: what came later is not in this report")
        if reader.damaged:
            lines.append(f"{reader.damaged} damaged parts of the file were left out")
        first = reader.info.first_tick
        if first:
            lines.append(f"the recording began with tick {first}: what was before is not in this report")
        return lines

    def _of_content(self, reader: RunReader) -> list[str]:
        story, lines = self._story, []
        if self._unread:
            lines.append(f"the reports of {self._unread} ticks cannot be read")
        if not story.ticks.rows:
            lines.append("the recording holds no tick")
        elif not story.states.rows:
            lines.append("no state of the robot is recorded: there is no path, and no clearance over time")
        if story.states.rows and story.scene is None:
            lines.append("no scene of the robot arrived: obstacles and targets are not drawn")
        promised = sum(reader.promised.get(topic, 0) for topic in FATE_TOPICS.values())
        lacking = max(0, promised - story.network.entries) + story.network.unread
        if lacking:
            lines.append(f"what became of {lacking} messages cannot be read: the network's figures lack them")
        if len(story.network.ways) == 1 or (reader.promised.get("") and not story.network.ways):
            lines.append("of the network a direction is missing: what describes its messages is damaged")
        if story.untold:
            lines.append(f"{story.untold} happenings beyond the first {MOST_HAPPENINGS} are not told of")
        return lines


def _few(lines: list[str], most: int = 5) -> list[str]:
    return lines if len(lines) <= most else [*lines[:most], f"and {len(lines) - most} further gaps"]
