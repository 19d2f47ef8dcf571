"""What the emulator asks of a packet's envelope, which is opaque to it otherwise."""


class MustArrive:
    """Base of the envelopes of messages that must not be lost: one that is dropped is offered again."""

    __slots__ = ()
