"""Episodes of a LeRobot dataset: a frame a tick, from the first that drives to the last, without a gap."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from farhand.common.messages.base import Quaternion
from farhand.common.messages.report import ControlReport
from farhand.common.messages.state import RobotState
from farhand.common.recording.decoded import DecodedTick
from farhand.common.recording.records import Gap
from farhand.exports.applied import Applied, Twist
from farhand.exports.images import Image
from farhand.exports.source import Item, Source

Values = dict[str, tuple[float, ...]]
DRIFT = 0.75
"""Of a period: as much may a tick be off its frame's time; more is a tick that was left out."""


@dataclass(frozen=True, slots=True)
class Frame:
    """Attributes:
    values: by feature.
    image: the newest picture that had arrived; None: there is no camera.
    """

    values: Values
    image: Image | None


@dataclass(slots=True)
class Episode:
    """Attributes:
    task: in words.
    frames: in order, one a period.
    """

    task: str
    frames: list[Frame] = field(default_factory=list)


def task_of(source: Source) -> str:
    """What was to be done."""
    scenario = source.info.scenario
    return str(scenario.get("description") or scenario.get("name") or "teleoperation")


class Episodes:
    """Cuts a run into episodes.

    Args:
        source: the run.
        period_ns: of its ticks.
        camera: whether frames have pictures; those before the first one are left out.
    """

    def __init__(self, source: Source, period_ns: int, *, camera: bool) -> None:
        self._source, self._period_ns, self._camera = source, period_ns, camera
        self._applied = Applied(source.info.session)
        self._state: RobotState | None = None
        self._image: Image | None = None
        self._episode = Episode(task_of(source))
        self._idle: list[Frame] = []  # joins the episode once driving goes on
        self._due_ns = 0
        self._turn: Quaternion | None = None
        self.foreign = self._count = 0

    def found(self) -> Iterator[Episode]:
        """All of them, each once it is over."""
        epoch_ns = self._source.info.epoch_ns
        for item in in_time(self._source.items(camera=self._camera), epoch_ns):
            if isinstance(item, Image):
                self._image = item
            elif isinstance(item, Gap):
                yield from self._over()
            elif isinstance(item, DecodedTick):
                yield from self._tick(item)
        yield from self._over()
        if self._count > 1:
            self._source.notes.append(
                f"it is {self._count} episodes: ticks are missing or were late in between, or not ours"
            )
        if self.foreign:
            self._source.notes.append(
                f"{self.foreign} ticks are left out: the robot followed commands that are not in the recording"
            )

    def _tick(self, tick: DecodedTick) -> Iterator[Episode]:
        now_ns = tick.record.now_ns
        if self._started and now_ns - self._due_ns > DRIFT * self._period_ns:
            yield from self._over()
        self._due_ns = (self._due_ns if self._started else now_ns) + self._period_ns
        for _, _, message in tick.news:
            if isinstance(message, RobotState):
                self._state = message
        frame = self._frame(tick.report)
        if tick.command is not None:
            self._applied.sent(tick.command)
        if frame is None or tick.report is None:
            yield from self._over()
        elif tick.report.mode == "run":
            self._episode.frames += [*self._idle, frame]
            self._idle = []
        elif self._started:
            self._idle.append(frame)

    @property
    def _started(self) -> bool:
        return bool(self._episode.frames)

    def _frame(self, report: ControlReport | None) -> Frame | None:
        state = self._state
        if report is None or state is None or (self._camera and self._image is None):
            return None
        applied = self._applied.at(state)
        if applied is None:
            self.foreign += 1
            return None
        self._turn = same_side(self._turn, state.orientation)
        return Frame(values_of(report, state, applied, self._turn), self._image)

    def _over(self) -> Iterator[Episode]:
        over, self._episode = self._episode, Episode(self._episode.task)
        self._idle = []
        self._turn = None
        if over.frames:
            self._count += 1
            yield over


def in_time(items: Iterable[Item], epoch_ns: int) -> Iterator[Item]:
    """The same, with each picture right before the first tick that began after it; in a file it stands after one."""
    pictures: list[Image] = []
    held: Item | None = None
    for item in items:
        if isinstance(item, Image):
            pictures.append(item)
            continue
        yield from _with_pictures(held, pictures, epoch_ns)
        held = item
    yield from _with_pictures(held, pictures, epoch_ns)


def _with_pictures(held: Item | None, pictures: list[Image], epoch_ns: int) -> Iterator[Item]:
    if isinstance(held, DecodedTick):
        now_ns = held.record.now_ns + epoch_ns
        yield from [each for each in pictures if each.log_ns <= now_ns]
        pictures[:] = [each for each in pictures if each.log_ns > now_ns]
    if held is not None:
        yield held


def same_side(before: Quaternion | None, now: Quaternion) -> Quaternion:
    """Of q and -q, which are one orientation, the one nearer to the one before; without one, of a fixed sign."""
    if before is None:
        along = next((each for each in now if abs(each) >= 0.5), 1.0)  # a unit quaternion has one
    else:
        along = sum(a * b for a, b in zip(before, now, strict=True))
    w, x, y, z = now
    return (-w, -x, -y, -z) if along < 0.0 else now


def values_of(report: ControlReport, state: RobotState, applied: Twist, orientation: Quaternion) -> Values:
    """All features of a frame."""
    velocity, angular = applied
    return {
        "action": (*report.desired, *report.desired_angular),
        "command.filtered": (*report.filtered, *report.angular),
        "command.applied": (*velocity, *angular),
        "observation.state": (*state.velocity, *state.angular_velocity),
        "observation.environment_state": (*state.position, *orientation, *state.joints),
        "safety.clearance": (state.clearance,),
        "safety.margin": (report.inflation,),
        "safety.intervening": (float(report.intervening),),
    }
