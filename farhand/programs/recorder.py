"""The program `farhand record`: comes for an operator's ticks and writes them, whatever becomes of that program.

It asks again and again rather than being sent to: so nothing is lost where it, the disk or the operator's program is
slow for a while, and one that comes late gets what was before.
"""

import math
import threading
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from farhand.common.messages.keys import check_robot_name
from farhand.common.process.outputs import check_writable, make_folder
from farhand.common.process.security import local_only
from farhand.common.process.signals import say, stop_event_on_signals
from farhand.common.recording.batch import TickBatch
from farhand.common.recording.run_file import RunFile
from farhand.common.timing.clock import SystemClock, local_timestamp, to_ns
from farhand.foxglove.view import views_of
from farhand.netem.control import control_endpoint
from farhand.programs.following.camera_tap import CameraTap
from farhand.programs.following.followed_run import FollowedRun
from farhand.programs.following.silence import Silence
from farhand.programs.following.tick_sources import Sources, opened

FRAMES_HZ, FRAMES_BYTES = 5.0, 40e3
"""Pictures a second, and their bytes, where nothing is said: 2.4 MB a minute at most, less than everything else."""
ASK_EVERY, REST_EVERY = 0.2, 0.05
REST_NS = to_ns(1.0)
"""How long, once it is told to end, it goes on for what an operator's program that ends as well still has to say."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RecorderOptions:
    """What `farhand record` is asked for.

    Attributes:
        robot: the robot's name.
        connect: the operator's report endpoint.
        netem: the emulator's control endpoint, for what became of every message; empty: not recorded.
        frames: pictures a second that are recorded, of a camera that takes more (1/s); None: FRAMES_HZ, and fewer
            where they would be more than FRAMES_BYTES.
        out: file to write; None: `runs/TIME-ROBOT.mcap`.
    """

    robot: str
    connect: str
    netem: str = ""
    frames: float | None = None
    out: Path | None = None


def recorder_program(options: RecorderOptions) -> int:
    """Record until the operator's program ends, or this one is told to; returns 0 where nothing is missing, else 1.

    An operator's program that does not answer for a while is waited for: what it kept meanwhile is fetched then.
    """
    robot = check_robot_name(options.robot)
    out = options.out or _new_file(robot)
    check_writable(out, "--out")
    connect = local_only(options.connect, "--connect")
    stop_event, clock = stop_event_on_signals(), SystemClock()
    recording = FollowedRun(lambda info: RunFile(out, info, views_of(info)))
    with ExitStack() as closing:
        operator = closing.enter_context(opened(connect))
        netem = closing.enter_context(opened(control_endpoint(options.netem))) if options.netem else None
        closing.callback(recording.close)
        say("record", f"waits for the operator of robot {robot!r} at {connect}; Ctrl-C ends it")
        rate, most = (FRAMES_HZ, FRAMES_BYTES) if options.frames is None else (options.frames, math.inf)
        camera = CameraTap(operator, robot, clock, rate, most=most)
        why = follow(recording, Sources(operator, netem, robot), camera, clock, stop_event)
    return _conclude(recording, out, why)


def _new_file(robot: str) -> Path:
    folder = Path("runs")
    make_folder(folder, "--out")
    return folder / f"{local_timestamp()}-{robot}.mcap"


def follow(
    recording: FollowedRun,
    sources: Sources,
    camera: CameraTap,
    clock: SystemClock,
    stop_event: threading.Event,
) -> str:
    """Fetch and write until the operator's program ends, is gone, or `stop_event` is set.

    Returns why what it did last may be missing; empty: nothing is.
    """
    silence = Silence(clock.now_ns())
    told_ns: int | None = None
    pause = threading.Event()
    while True:
        batch = sources.ticks(recording.next, recording.written)
        now_ns = clock.now_ns()
        if told_ns is None and stop_event.is_set():
            told_ns = now_ns
        if batch is not None:
            _say(silence.broken(now_ns))
            _take(recording, batch, sources, camera)
            if recording.done:
                return (
                    ""
                    if recording.whole
                    else "the operator's program is another one now, with a run of its own"
                )
            if batch.more:
                continue
        elif recording.file is None:
            _say(silence.before_the_first(now_ns))
        else:
            _say(silence.goes_on(now_ns))
            if silence.is_for_good(now_ns, connected=sources.connected()):
                return silence.words(now_ns)
        if told_ns is not None and batch is None:
            return "the operator's program does not answer any more" if recording.file is not None else ""
        if told_ns is not None and now_ns - told_ns > REST_NS:
            return ""
        (stop_event if told_ns is None else pause).wait(ASK_EVERY if told_ns is None else REST_EVERY)


def _take(recording: FollowedRun, batch: TickBatch, sources: Sources, camera: CameraTap) -> None:
    if recording.file is None:
        say("record", f"records run {batch.info.scenario.get('name', '')!r}")
    recording.take(batch)
    recording.take_frames(camera.frames())
    recording.take_all_fates(sources)


def _say(line: str) -> None:
    if line:
        say("record", line)


def _conclude(recording: FollowedRun, out: Path, why: str) -> int:
    """Say what is there and, last, what is not: others quote the last line."""
    file = recording.file
    if file is None:
        say("record", "nothing was recorded: no operator's program answered")
        return 1
    fates = recording.fates - file.missing_fates
    messages = f", what became of {fates} messages" if recording.fates else ""
    say("record", f"{recording.next - recording.first - file.missing} ticks{messages} in {out}")
    if recording.elsewhere:
        say("record", "no command of this run came by the emulator: what became of its messages is not there")
    if recording.missing_fates:
        say("record", f"of {recording.missing_fates} messages the emulator knows no more what became of them")
    if why:
        say("record", f"{why}: what was done after tick {recording.next - 1}, if anything was, is not there")
    if file.missing_fates:
        say("record", f"{out}: what became of {file.missing_fates} messages is missing: it cannot be written")
    if file.trouble:
        say("record", f"{out}: {file.missing} ticks are missing: {file.trouble}")
    return 1 if file.missing or why else 0
