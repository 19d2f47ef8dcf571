"""A recording that viewers play, pause and seek: what they ask for, and what it does until the next time."""

import threading

from foxglove.websocket import PlaybackCommand, PlaybackControlRequest, PlaybackState, PlaybackStatus

from farhand.foxglove.player import Player

FASTEST = 100.0


class Playback:
    """One thread goes on with it, told the time; the server's own threads ask.

    Args:
        player: what is played.
        start_ns, end_ns: of the recording (ns).

    Attributes:
        asked: set whenever a viewer asked for something.
    """

    def __init__(self, player: Player, start_ns: int, end_ns: int) -> None:
        self.asked = threading.Event()
        self._player, self._start_ns, self._end_ns = player, start_ns, end_ns
        self._lock = threading.Lock()
        self._playing, self._speed = False, 1.0
        self._shown_ns = start_ns
        self._seek_ns: int | None = start_ns
        self._ended = False
        self._now_ns: int | None = None

    def subscribed(self) -> None:
        """A viewer looks at one topic more: it gets what stands."""
        with self._lock:
            self._seek_ns = self._shown_ns if self._seek_ns is None else self._seek_ns
        self.asked.set()

    def control(self, request: PlaybackControlRequest) -> PlaybackState:
        """What a viewer asks for; returns what it is then."""
        with self._lock:
            if request.seek_time is not None:
                self._shown_ns = min(max(request.seek_time, self._start_ns), self._end_ns)
                self._seek_ns = self._shown_ns
                self._ended = False
            if 0.0 < request.playback_speed <= FASTEST:
                self._speed = request.playback_speed
            self._playing = request.playback_command == PlaybackCommand.Play and not self._at_end
            self._ended = self._ended or self._at_end
            state = self._state(did_seek=request.seek_time is not None, request_id=request.request_id)
        self.asked.set()
        return state

    def go_on(self, now_ns: int) -> PlaybackState | None:
        """Say what is due at an instant of the program's clock (ns); returns a new state where it ended."""
        with self._lock:
            seek_ns, self._seek_ns = self._seek_ns, None
            passed_ns = 0 if self._now_ns is None else now_ns - self._now_ns
            self._now_ns = now_ns
            playing, speed, shown_ns = self._playing, self._speed, self._shown_ns
        if seek_ns is not None:
            self._player.seek(seek_ns)
            shown_ns, passed_ns = seek_ns, 0
        if playing:
            shown_ns = min(shown_ns + int(passed_ns * speed), self._end_ns)
            self._player.advance(shown_ns)
        with self._lock:
            if self._is_asked():  # meanwhile: that counts
                return None
            self._shown_ns = shown_ns
            if not (self._playing and self._at_end):
                return None
            self._playing, self._ended = False, True
            return self._state(did_seek=False, request_id=None)

    def _is_asked(self) -> bool:
        return self._seek_ns is not None

    @property
    def state(self) -> PlaybackState:
        """What it does now."""
        with self._lock:
            return self._state(did_seek=False, request_id=None)

    @property
    def shown_ns(self) -> int:
        """The instant that is shown (ns)."""
        return self._shown_ns

    @property
    def playing(self) -> bool:
        """Whether time goes on."""
        return self._playing

    @property
    def _at_end(self) -> bool:
        return self._shown_ns >= self._end_ns

    def _state(self, *, did_seek: bool, request_id: str | None) -> PlaybackState:
        status = PlaybackStatus.Playing if self._playing else PlaybackStatus.Paused
        return PlaybackState(
            status=PlaybackStatus.Ended if self._ended else status,
            current_time=self._shown_ns,
            playback_speed=self._speed,
            did_seek=did_seek,
            request_id=request_id,
        )
