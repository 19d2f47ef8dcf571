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
from farhand.common.recording.run_file import RunFile
from farhand.common.timing.clock import SystemClock, local_timestamp, to_ns
from farhand.foxglove.view import views_of
from farhand.netem.control import control_endpoint
from farhand.programs.camera_tap import CameraTap
from farhand.programs.followed_run import FollowedRun
from farhand.programs.tick_sources import Sources, opened

FRAMES_HZ, FRAMES_BYTES = 5.0, 40e3
"""Pictures a second, and their bytes, where nothing is said: 2.4 MB a minute at most, less than everything else."""
ASK_EVERY, REST_EVERY = 0.2, 0.05
REST_NS = to_ns(1.0)
"""How long, once it is told to end, it goes on for what an operator's program that ends as well still has to say."""
GONE_AFTER_NS = to_ns(3.0)
SAY_AFTER_NS = to_ns(5.0)


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
    """Record until the operator's program ends, or this one is told to; returns 0 where nothing is missing, else 1."""
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
        _record(recording, Sources(operator, netem, robot), camera, clock, stop_event)
    return _conclude(recording, out, told=stop_event.is_set())


def _new_file(robot: str) -> Path:
    folder = Path("runs")
    make_folder(folder, "--out")
    return folder / f"{local_timestamp()}-{robot}.mcap"


def _record(
    recording: FollowedRun,
    sources: Sources,
    camera: CameraTap,
    clock: SystemClock,
    stop_event: threading.Event,
) -> None:
    heard_ns = clock.now_ns()
    told_ns: int | None = None
    said, pause = False, threading.Event()
    while not recording.done:
        batch = sources.ticks(recording.next, recording.written)
        now_ns = clock.now_ns()
        if told_ns is None and stop_event.is_set():
            told_ns = now_ns
        if batch is not None:
            if recording.file is None:
                say("record", f"records run {batch.info.scenario.get('name', '')!r}")
            heard_ns = now_ns
            recording.take(batch)
            recording.take_frames(camera.frames())
            recording.take_all_fates(sources)
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


def _conclude(recording: FollowedRun, out: Path, *, told: bool) -> int:
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
