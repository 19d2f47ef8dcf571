"""The live server that Foxglove opens: topics of a run, the run's own time, and what is wrong with it."""

from collections.abc import Callable
from pathlib import Path

import foxglove
from foxglove import Context, StatusLevel
from foxglove.websocket import (
    Capability,
    ChannelView,
    Client,
    PlaybackControlRequest,
    PlaybackState,
    ServerListener,
)

from farhand.common.errors import EndpointError
from farhand.common.recording.mcap_file import ChannelSpec
from farhand.foxglove.channels import Channels

BACKLOG = 8192
"""Messages that wait for a slow viewer, at most; the oldest go first."""


class Listener(ServerListener):
    """What viewers want; its methods are called by the server's own threads.

    Args:
        subscribed: called when a viewer begins to look at a topic.
        control: called with what a viewer asks of a playback; says what it is then.
    """

    def __init__(
        self,
        subscribed: Callable[[], None],
        control: Callable[[PlaybackControlRequest], PlaybackState] | None = None,
    ) -> None:
        self._subscribed, self._control = subscribed, control

    def on_subscribe(self, client: Client, channel: ChannelView) -> None:
        """See ServerListener."""
        self._subscribed()

    def on_playback_control_request(
        self, playback_control_request: PlaybackControlRequest
    ) -> PlaybackState | None:
        """See ServerListener."""
        return None if self._control is None else self._control(playback_control_request)


class Server:
    """Args:
    name: that viewers show.
    host, port: where; port 0: any that is free.
    listener: see Listener.
    span_ns: first and last instant, where it is a recording that viewers play and pause; None: it is live.

    Attributes:
        context: for channels of this server.

    Raises:
        EndpointError: the port is taken.
    """

    def __init__(
        self, name: str, host: str, port: int, listener: Listener, span_ns: tuple[int, int] | None = None
    ) -> None:
        self.context = Context()
        self._channels: Channels | None = None
        try:
            self._server = foxglove.start_server(
                name=name,
                host=host,
                port=port,
                capabilities=[Capability.Time],
                server_listener=listener,
                context=self.context,
                playback_time_range=span_ns,
                message_backlog_size=BACKLOG,
            )
        except (OSError, RuntimeError) as error:
            why = str(error).removeprefix("FoxgloveError: ").removeprefix("Failed to bind port: ")
            raise EndpointError(f"--listen {host}:{port}: {why}; choose another port") from None

    @property
    def port(self) -> int:
        """Where it listens."""
        return self._server.port

    @property
    def link(self) -> str:
        """A page that opens it."""
        return self._server.app_url() or ""

    def channels(self, specs: tuple[ChannelSpec, ...]) -> Channels:
        """Channels for these topics; those that are there already, where they are the same."""
        if self._channels is None or self._channels.specs != specs:
            self._channels = Channels(specs, self.context)
        return self._channels

    def time(self, time_ns: int) -> None:
        """What time it is in the run (ns)."""
        self._server.broadcast_time(time_ns)

    def state(self, state: PlaybackState) -> None:
        """What the playback does now."""
        self._server.broadcast_playback_state(state)

    def trouble(self, words: str) -> None:
        """Say what is wrong, until it is well."""
        self._server.publish_status(words, StatusLevel.Error, "run")

    def well(self) -> None:
        """Nothing is wrong any more."""
        self._server.remove_status(["run"])

    def another_run(self) -> None:
        """Viewers forget what they have seen."""
        self._server.clear_session()

    def close(self) -> None:
        """Serve no more."""
        self._server.stop()


def opened_by(server: Server, layout: Path) -> str:
    """How to look at it, for people."""
    return f"open {server.link} (or Foxglove's own: Open connection, ws://...:{server.port}); layout: import {layout}"
