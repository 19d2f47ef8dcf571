"""What a recorder asks an operator's program for on its own host, and what it gets."""

from typing import Annotated

from msgspec import Meta, Struct

from farhand.common.recording.records import RunInfo, TickRecord

BATCH_BYTES = 1 << 20
"""Ticks in one answer, about."""


class TicksWanted(Struct, frozen=True, kw_only=True, omit_defaults=True, forbid_unknown_fields=True):
    """Attributes:
    since: number of the first tick that is wanted.
    written: number after the last tick that is in a file; None: whoever asks writes none, or could not.
    """

    since: Annotated[int, Meta(ge=0, le=2**62)]
    written: Annotated[int, Meta(ge=0, le=2**62)] | None = None


class TickBatch(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Attributes:
    info: of the run.
    ticks: from the wanted one on, in order; the first may be a later one, where the wanted is kept no more.
    more: there are further ones.
    ended: the program is ending: what it has said is all.
    """

    info: RunInfo
    ticks: tuple[TickRecord, ...]
    more: bool
    ended: bool
