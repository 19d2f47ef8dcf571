"""The program `farhand record`: comes for an operator's ticks and writes them, whatever becomes of that program.

It asks again and again rather than being sent to: so nothing is lost where it, the disk or the operator's program is
slow for a while, and one that comes late gets what was before.
"""

import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import msgspec
import zenoh

from farhand.common.errors import RunFileError
from farhand.common.link.zenoh_link import open_session
from farhand.common.messages.camera import CameraFrame
from farhand.common.messages.keys import check_robot_name, ticks_key
from farhand.common.process.outputs import check_writable, make_folder
from farhand.common.process.security import local_only
from farhand.common.process.signals import say, stop_event_on_signals
from farhand.common.recording.batch import TickBatch, TicksWanted
from farhand.common.recording.fates import FATES_KEY, FateBatch, FatesWanted
from farhand.common.recording.json_view import View
from farhand.common.recording.records import Gap, RunInfo
from farhand.common.recording.run_file import RunFile
from farhand.common.timing.clock import SystemClock, local_timestamp, to_ns
from farhand.foxglove.view import views_of
from farhand.netem.control import control_endpoint
from farhand.programs.camera_tap import CameraTap

B = TypeVar("B")

FRAMES_HZ = 5.0
"""A picture of 8 kB five times a second is 2.4 MB a minute, which is about what everything else is."""
ASK_EVERY, REST_EVERY = 0.2, 0.05
ANSWER_WITHIN = 1.0
REST_NS = to_ns(1.0)
"""How long, once it is told to end, it goes on for what an operator's program that ends as well still has to say."""
GONE_AFTER_NS = to_ns(3.0)
SAY_AFTER_NS = to_ns(5.0)
TOO_LATE = "the operator's program keeps them no more: they were not asked for in time"


@dataclass(frozen=True, slots=True, kw_only=True)
class RecorderOptions:
    """What `farhand record` is asked for.

    Attributes:
        robot: the robot's name.
        connect: the operator's report endpoint.
        netem: the emulator's control endpoint, for what became of every message; empty: not recorded.
        frames: pictures a second that are recorded, of a camera that takes more (1/s).
        out: file to write; None: `runs/TIME-ROBOT.mcap`.
    """

    robot: str
    connect: str
    netem: str = ""
    frames: float = FRAMES_HZ
    out: Path | None = None


class Recording:
    """The file that batches of ticks go into.

    Args:
        path: of the file.
        views: makes what is told beside the ticks.

    Attributes:
        next, next_fate: numbers of the first tick and fate that are not in it.
        missing_fates: that an emulator kept no more.
        first: number of the first tick that is.
        done: nothing more will come.
        whole: the operator's program said itself that this was all.
        file: None until the first batch.
    """

    def __init__(self, path: Path, views: Callable[[RunInfo], Sequence[View]] = views_of) -> None:
        self.next = self.first = 0
        self.done = self.whole = False
        self.file: RunFile | None = None
        self._path, self._views = path, views
        self._session = self._netem = 0
        self.next_fate = self.missing_fates = 0
        self._last_ns = 0

    def take(self, batch: TickBatch) -> None:
        """Write a batch; raises RunFileError where the file cannot be begun."""
        if self.file is None:
            self._begin(batch)
        if batch.info.session != self._session:  # it was started anew: that is another run
            self.done = True
            return
        assert self.file is not None
        for tick in batch.ticks:
            if tick.number > self.next:
                self.file.gap(
                    Gap(
                        ticks=tick.number - self.next,
                        first_ns=self._last_ns,
                        last_ns=tick.now_ns,
                        why=TOO_LATE,
                    )
                )
            if tick.number >= self.next:
                self.file.tick(tick)
                self.next, self._last_ns = tick.number + 1, tick.now_ns
        if not batch.more:
            self.file.flush()
        self.done = self.whole = batch.ended

    def take_frames(self, frames: Sequence[tuple[int, CameraFrame]]) -> None:
        """Write pictures, each with its time of day; those before the run's first tick are left out."""
        if self.file is None:
            return
        for at_ns, frame in frames:
            self.file.frame(frame, at_ns)

    def take_fates(self, batch: FateBatch) -> None:
        """Write what became of messages; what came before the run's first tick waits for the file."""
        if self.file is None or batch.session != (self._netem or batch.session):
            return
        self._netem = batch.session
        for fate in batch.fates:
            self.file.fate(fate, batch.epoch_ns)
        self.missing_fates += batch.first - self.next_fate
        self.next_fate = batch.first + len(batch.fates)

    def close(self) -> None:
        """Finish the file."""
        self.done = True
        if self.file is not None:
            self.file.close()

    def _begin(self, batch: TickBatch) -> None:
        first = batch.ticks[0].number if batch.ticks else 0
        info = msgspec.structs.replace(batch.info, first_tick=first)
        self.file = RunFile(self._path, info, self._views(info))
        self._session, self.next, self.first = info.session, first, first


def recorder_program(options: RecorderOptions) -> int:
    """Record until the operator's program ends, or this one is told to; returns 0 where nothing is missing, else 1."""
    robot = check_robot_name(options.robot)
    out = options.out or _new_file(robot)
    check_writable(out, "--out")
    connect = local_only(options.connect, "--connect")
    stop_event, clock = stop_event_on_signals(), SystemClock()
    recording = Recording(out)
    with ExitStack() as closing:
        operator = closing.enter_context(_opened(connect))
        netem = closing.enter_context(_opened(control_endpoint(options.netem))) if options.netem else None
        closing.callback(recording.close)
        say("record", f"waits for the operator of robot {robot!r} at {connect}; Ctrl-C ends it")
        camera = CameraTap(operator, robot, clock, options.frames)
        _record(recording, Sources(operator, netem, robot, camera), clock, stop_event)
    return _conclude(recording, out, told=stop_event.is_set())


@contextmanager
def _opened(endpoint: str) -> Iterator[zenoh.Session]:
    session = open_session([endpoint])
    try:
        yield session
    finally:
        session.close()  # type: ignore[no-untyped-call]


def _new_file(robot: str) -> Path:
    folder = Path("runs")
    make_folder(folder, "--out")
    return folder / f"{local_timestamp()}-{robot}.mcap"


class Sources:
    """What is recorded from.

    Args:
        operator: session to the operator's program.
        netem: session to the emulator; None: it is not recorded.
        robot: the robot's name.
        camera: pictures that pass the operator's program.
    """

    def __init__(
        self, operator: zenoh.Session, netem: zenoh.Session | None, robot: str, camera: CameraTap
    ) -> None:
        self._operator, self._netem, self._key = operator, netem, ticks_key(robot)
        self.camera = camera

    def ticks(self, since: int) -> TickBatch | None:
        """The ticks from a number on; None: nobody answers. Raises RunFileError where the answer cannot be read."""
        return _ask(self._operator, self._key, TicksWanted(since=since), TickBatch)

    def fates(self, since: int) -> FateBatch | None:
        """The same of what became of messages."""
        if self._netem is None:
            return None
        return _ask(self._netem, FATES_KEY, FatesWanted(since=since), FateBatch)


def _record(recording: Recording, sources: Sources, clock: SystemClock, stop_event: threading.Event) -> None:
    heard_ns = clock.now_ns()
    told_ns: int | None = None
    said, pause = False, threading.Event()
    while not recording.done:
        batch = sources.ticks(recording.next)
        now_ns = clock.now_ns()
        if told_ns is None and stop_event.is_set():
            told_ns = now_ns
        if batch is not None:
            if recording.file is None:
                say("record", f"records run {batch.info.scenario.get('name', '')!r}")
            heard_ns = now_ns
            recording.take(batch)
            recording.take_frames(sources.camera.frames())
            _take_fates(recording, sources)
            if batch.more:
                continue
        elif recording.file is not None and now_ns - heard_ns > GONE_AFTER_NS:
            return
        elif recording.file is None and not said and now_ns - heard_ns > SAY_AFTER_NS:
            said = True
            say("record", "nobody answers for 5 s; still trying (`farhand operator --report ENDPOINT` does)")
        if told_ns is not None and (batch is None or now_ns - told_ns > REST_NS):
            return
        if not recording.done:
            (stop_event if told_ns is None else pause).wait(ASK_EVERY if told_ns is None else REST_EVERY)


def _take_fates(recording: Recording, sources: Sources) -> None:
    more = True
    while more:
        fates = sources.fates(recording.next_fate)
        if fates is None:
            return
        recording.take_fates(fates)
        more = fates.more


def _ask(session: zenoh.Session, key: str, wanted: object, kind: type[B]) -> B | None:
    payload = msgspec.json.encode(wanted)
    for reply in session.get(key, payload=payload, timeout=ANSWER_WITHIN):
        if reply.ok is None:
            continue
        try:
            return msgspec.msgpack.decode(reply.ok.payload.to_bytes(), type=kind)
        except msgspec.MsgspecError as error:
            raise RunFileError(f"record: an answer cannot be read: {error}; is it another version?") from None
    return None


def _conclude(recording: Recording, out: Path, *, told: bool) -> int:
    file = recording.file
    if file is None:
        say("record", "nothing was recorded: no operator's program answered")
        return 1
    if file.trouble:
        say("record", f"{out}: {file.missing} ticks are missing: {file.trouble}")
    if not recording.whole and not told:
        say("record", "the operator's program is gone without a word; all that it had said is there")
    if recording.missing_fates:
        say("record", f"of {recording.missing_fates} messages the emulator knows no more what became of them")
    messages = (
        f", what became of {recording.next_fate - recording.missing_fates} messages"
        if recording.next_fate
        else ""
    )
    say("record", f"{recording.next - recording.first} ticks{messages} in {out}")
    return 0 if not file.missing and (recording.whole or told) else 1
