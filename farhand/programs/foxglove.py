"""The program `farhand foxglove`: a run for Foxglove, live or from a recording."""

import threading
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from farhand.common.errors import InputError
from farhand.common.link.endpoints import is_loopback
from farhand.common.messages.keys import check_robot_name
from farhand.common.process.security import local_only
from farhand.common.process.signals import say, stop_event_on_signals
from farhand.common.recording.batch import TickBatch
from farhand.common.recording.place import recording_at
from farhand.common.recording.records import RunInfo
from farhand.common.recording.run_file import RunFile
from farhand.common.timing.clock import SystemClock, to_ns
from farhand.foxglove.channels import Channels
from farhand.foxglove.layout import SHIPPED
from farhand.foxglove.playback import Playback
from farhand.foxglove.player import Player
from farhand.foxglove.recorded_topics import RecordedTopics
from farhand.foxglove.server import Listener, Server, opened_by
from farhand.foxglove.view import views_of
from farhand.netem.control import control_endpoint
from farhand.programs.following.camera_tap import CameraTap
from farhand.programs.following.followed_run import FollowedRun
from farhand.programs.following.tick_sources import Sources, opened

ASK_EVERY = 0.05
FRAMES_HZ = 20.0
STEP, REST = 0.02, 0.2
"""s between two steps of a playback that plays, and that stands."""
CHECKED_AT_ONCE = 20
"""Chunks, of half a second each: some 20 ms."""
SILENT_AFTER_NS = to_ns(2.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class FoxgloveOptions:
    """What `farhand foxglove` is asked for.

    Attributes:
        run: a recording; None: a running operator.
        connect: its report endpoint.
        robot: the robot's name.
        netem: the emulator's control endpoint, for what became of every message; empty: not shown.
        listen: HOST:PORT for viewers.
    """

    run: Path | None
    connect: str
    robot: str
    netem: str = ""
    listen: str = "127.0.0.1:8765"


def foxglove_program(options: FoxgloveOptions) -> int:
    """Serve until it is told to end; returns 0. Raises InputError."""
    host, port = _host_and_port(options.listen)
    if not is_loopback(f"tcp/{host}:1"):
        say("foxglove", f"listens at {host}: whoever reaches it sees the run, and can move nothing")
    stop_event, clock = stop_event_on_signals(), SystemClock()
    with ExitStack() as closing:
        if options.run is not None:
            _play(options.run, host, port, clock, stop_event, closing)
        else:
            _follow(options, host, port, clock, stop_event, closing)
    return 0


def _play(
    run: Path, host: str, port: int, clock: SystemClock, stop_event: threading.Event, closing: ExitStack
) -> None:
    topics = RecordedTopics(recording_at(run))
    closing.callback(topics.close)
    channels: list[Channels] = []
    playback = Playback(
        Player(topics, lambda number, log_ns, data: channels[0].add(number, log_ns, data)),
        topics.start_ns,
        topics.end_ns,
    )
    listener = Listener(playback.subscribed, playback.control)
    server = Server(f"farhand: {run}", host, port, listener, (topics.start_ns, topics.end_ns))
    closing.callback(server.close)
    channels.append(server.channels(topics.specs))
    say("foxglove", f"{opened_by(server, SHIPPED)}; Ctrl-C ends it")
    told_ns, lacks = -1, Lacks(str(run), topics, server)
    while not stop_event.is_set():
        asked = playback.asked.is_set()
        lacks.tell(asked=asked)
        playback.asked.clear()
        changed = playback.go_on(clock.now_ns())
        if asked or playback.shown_ns != told_ns:
            told_ns = playback.shown_ns
            server.time(told_ns)
        if changed is not None:
            server.state(changed)
        if topics.checked:
            _pause(stop_event, playback)


class Lacks:
    """Tells what is missing in a recording, in the terminal and to viewers, from the start on.

    A long file is looked through a part at a time, so that what is asked meanwhile is answered.

    Args:
        run: how the recording is called.
        topics: of it.
        server: for viewers.
    """

    def __init__(self, run: str, topics: RecordedTopics, server: Server) -> None:
        self._run, self._topics, self._server = run, topics, server
        self._told: list[str] = []

    def tell(self, *, asked: bool) -> None:
        """Look on, and tell what is new; all of it where somebody asked, who may not have been there before."""
        topics = self._topics
        topics.check(CHECKED_AT_ONCE)
        lacks = topics.lacks if topics.checked else self._told
        for line in lacks:
            if line not in self._told:
                say("foxglove", f"{self._run}: {line}")
        if lacks and (asked or lacks != self._told):
            self._server.trouble("; ".join(lacks))
        self._told = lacks


def _pause(stop_event: threading.Event, playback: Playback) -> None:
    """Until the next step, or until somebody asks for something."""
    if playback.playing:
        stop_event.wait(STEP)
    else:
        playback.asked.wait(REST)


def _follow(
    options: FoxgloveOptions,
    host: str,
    port: int,
    clock: SystemClock,
    stop_event: threading.Event,
    closing: ExitStack,
) -> None:
    robot = check_robot_name(options.robot)
    connect = local_only(options.connect, "--connect")
    again = threading.Event()
    server = Server(f"farhand: {robot}", host, port, Listener(again.set))
    closing.callback(server.close)
    operator = closing.enter_context(opened(connect))
    netem = closing.enter_context(opened(control_endpoint(options.netem))) if options.netem else None
    say("foxglove", f"{opened_by(server, SHIPPED)}; shows robot {robot!r} at {connect}; Ctrl-C ends it")
    camera = CameraTap(operator, robot, clock, FRAMES_HZ)
    live = Live(server, Sources(operator, netem, robot), again, camera)
    while not stop_event.is_set():
        more = live.step(clock.now_ns())
        if not more:
            stop_event.wait(ASK_EVERY)


class Live:
    """A running operator for viewers; what it does not say is not shown, and that it says nothing is.

    Args:
        server: for viewers.
        sources: of the ticks.
        again: set when a viewer begins to look: it is told what is wrong as well.
        camera: pictures that pass the operator's program; None: they are not shown.
    """

    def __init__(
        self, server: Server, sources: Sources, again: threading.Event, camera: CameraTap | None = None
    ) -> None:
        self._server, self._sources, self._again, self._camera = server, sources, again, camera
        self._run: FollowedRun | None = None
        self._heard_ns: int | None = None
        self._shows = False
        self._trouble = ""
        self._ended = 0

    def step(self, now_ns: int) -> bool:
        """Ask for what is new and send it; returns whether there is more at once."""
        run = self._run = self._run or FollowedRun(self._begin)
        batch = self._sources.ticks(run.next)
        if batch is not None and batch.info.session == self._ended:
            batch = None  # it lingers, and has said all
        self._heard_ns = now_ns if self._heard_ns is None else self._heard_ns
        if batch is not None and batch.ticks:
            self._heard_ns, self._shows = now_ns, True
        if batch is not None:
            self._take(run, batch)
        if batch is not None and batch.ended:
            self._is_wrong("the operator's program has ended; what is shown is its last")
        elif now_ns - self._heard_ns > SILENT_AFTER_NS and not self._ended:
            shown = "what is shown is old" if self._shows else "nothing is shown yet"
            self._is_wrong(f"nothing is heard of the operator's program; {shown}")
        elif batch is not None and batch.ticks:
            self._is_well()
        if self._again.is_set():
            self._again.clear()
            if self._trouble:
                self._server.trouble(self._trouble)
        return batch is not None and batch.more

    def _begin(self, info: RunInfo) -> RunFile:
        say("foxglove", f"shows run {info.scenario.get('name', '')!r}")
        return RunFile(Path(), info, views_of(info), into=self._server.channels)

    def _take(self, run: FollowedRun, batch: TickBatch) -> None:
        known = run.file is not None
        run.take(batch)
        if self._camera is not None:
            run.take_frames(self._camera.frames())
        run.take_all_fates(self._sources)
        if batch.ticks and not run.done:
            self._server.time(batch.ticks[-1].now_ns + batch.info.epoch_ns)
        if run.done:
            run.close()
            self._run = None
            self._ended = batch.info.session if run.whole else 0
            if known and not run.whole:  # another program answers in its place
                self._server.another_run()

    def _is_wrong(self, words: str) -> None:
        if words != self._trouble:
            self._trouble = words
            self._server.trouble(words)
            say("foxglove", words)

    def _is_well(self) -> None:
        if self._trouble:
            self._trouble = ""
            self._server.well()
            say("foxglove", "the operator's program is heard again")


def _host_and_port(listen: str) -> tuple[str, int]:
    host, _, port = listen.rpartition(":")
    if not host or not port.isdigit() or not 0 <= int(port) < 65536:
        raise InputError(f"--listen {listen!r}: expected HOST:PORT such as 127.0.0.1:8765")
    return host.strip("[]"), int(port)
