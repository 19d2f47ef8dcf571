"""A run's topics on a live server: what takes the messages in place of a file."""

from collections.abc import Iterable

from foxglove import Channel, Context, Schema

from farhand.common.recording.mcap_file import ChannelSpec


class Channels:
    """Channels of a server, numbered from 1 on in their order, as those of a file.

    Args:
        specs: what there is.
        context: of the server.

    Attributes:
        quiet: messages are not sent, as they are only history.
    """

    def __init__(self, specs: Iterable[ChannelSpec], context: Context) -> None:
        self.specs = tuple(specs)
        self.quiet = False
        self._channels = [
            Channel(
                spec.topic,
                schema=Schema(name=spec.schema, encoding=spec.schema_encoding, data=spec.schema_data),
                message_encoding=spec.encoding,
                context=context,
            )
            for spec in self.specs
        ]

    waiting = 0
    """See Messages: nothing waits."""

    def add(self, channel: int, log_ns: int, data: bytes, sequence: int = 0) -> None:
        """Send a message to whoever listens."""
        if not self.quiet:
            self._channels[channel - 1].log(data, log_time=log_ns)

    def metadata(self, name: str, data: dict[str, str]) -> None:
        """See Messages; who looks on sees a gap as time without messages."""

    def flush(self) -> None:
        """See Messages."""

    def discard(self) -> None:
        """See Messages."""

    def close(self) -> None:
        """See Messages; the channels stay for the next run."""
