"""MessagePack <-> messages, validated at the edge: what is not exactly right is refused and counted."""

import math
import re
from collections import Counter
from typing import Generic, TypeVar
from zlib import crc32

import msgspec

from farhand.common.errors import FarhandError
from farhand.common.messages.base import SCHEMA, Message

MAX_PAYLOAD = 1 << 20

M = TypeVar("M", bound=Message)

_encoder = msgspec.msgpack.Encoder()
_CHECK_KEY = b"\xa5check\xce"  # the key and the head of a uint32, which the four bytes of the CRC follow


class CodecError(FarhandError):
    """A payload was refused.

    Attributes:
        reason: one word: length, malformed, checksum, schema, unknown-field, non-finite or type.
    """

    def __init__(self, reason: str, detail: str) -> None:
        super().__init__(f"{reason}: {detail}")
        self.reason = reason


def encode(message: Message) -> bytes:
    """MessagePack map of a message, its last field `check` the CRC-32 of all bytes before those four.

    TCP's and Zenoh's own checks end at their last hop; this one spans from program to program.
    """
    body = _one_field_more(_encoder.encode(message)) + _CHECK_KEY
    return body + crc32(body).to_bytes(4, "big")


def _one_field_more(encoded: bytes) -> bytes:
    """The same map with a head that announces one field more."""
    head = encoded[0]
    if 0x80 <= head < 0x8F:  # fixmap
        return bytes((head + 1,)) + encoded[1:]
    fields, rest = (15, encoded[1:]) if head == 0x8F else (int.from_bytes(encoded[1:3], "big"), encoded[3:])
    return b"\xde" + (fields + 1).to_bytes(2, "big") + rest  # map 16


def is_sealed(payload: bytes, check: int) -> bool:
    """Whether `check` stands at the end of the payload and is the CRC-32 of what is before it."""
    return payload[-11:-4] == _CHECK_KEY and crc32(payload[:-4]) == check


# A number that is not finite has all bits of its exponent set. Elsewhere those bytes mean nothing, so that only where
# they are found is every field looked at. Two patterns: one that begins with a byte and no choice is found faster.
_NON_FINITE_64 = re.compile(rb"\xcb[\x7f\xff][\xf0-\xff]", re.DOTALL).search
_NON_FINITE_32 = re.compile(rb"\xca[\x7f\xff][\x80-\xff]", re.DOTALL).search


class Decoder(Generic[M]):
    """Decodes one kind of message and counts what it refuses.

    Args:
        kind: the message class.
    """

    def __init__(self, kind: type[M]) -> None:
        self._decoder = msgspec.msgpack.Decoder(kind)
        self.refused: Counter[str] = Counter()
        self.last_refusal = ""

    def decode(self, payload: bytes) -> M | None:
        """The message, or None when it was refused (`last_refusal` says why)."""
        try:
            return self.decode_or_raise(payload)
        except CodecError as error:
            self.refused[error.reason] += 1
            self.last_refusal = str(error)
            return None

    def decode_or_raise(self, payload: bytes) -> M:
        """The message; raises CodecError with a reason."""
        if not 0 < len(payload) <= MAX_PAYLOAD:
            raise CodecError("length", f"{len(payload)} bytes, at most {MAX_PAYLOAD}")
        try:
            message = self._decoder.decode(payload)
        except msgspec.ValidationError as error:
            raise CodecError(_validation_reason(str(error), payload), str(error)) from None
        except (msgspec.DecodeError, ValueError, RecursionError, OverflowError) as error:
            raise CodecError("malformed", str(error)) from None
        if message.check is not msgspec.UNSET:
            if not is_sealed(payload, message.check):
                raise CodecError("checksum", "the bytes are not those that were sent")
            msgspec.structs.force_setattr(message, "check", msgspec.UNSET)
        if message.schema != SCHEMA:
            raise CodecError("schema", f"version {message.schema}, this program speaks {SCHEMA}")
        suspect = _NON_FINITE_64(payload) or _NON_FINITE_32(payload)
        field = _non_finite_field(message) if suspect else None
        if field is not None:
            raise CodecError("non-finite", f"field {field}")
        return message


def _validation_reason(text: str, payload: bytes) -> str:
    """The one word for a validation error; a foreign schema version explains all else."""
    try:
        found = msgspec.msgpack.decode(payload)
        finite = _finite(found)
    except (msgspec.DecodeError, ValueError, TypeError, RecursionError):
        return "malformed"
    if isinstance(found, dict) and found.get("schema", SCHEMA) != SCHEMA:
        return "schema"
    if "unknown field" in text:
        return "unknown-field"
    if "length" in text:
        return "length"
    return "type" if finite else "non-finite"


def _non_finite_field(message: Message) -> str | None:
    """Name of a field that holds a number that is not finite, or None."""
    for name in message.__struct_fields__:
        if not _finite(getattr(message, name)):
            return name
    return None


def _finite(value: object) -> bool:
    kind = type(value)
    if kind is float:
        return math.isfinite(value)  # type: ignore[arg-type]
    if kind is int or kind is str or value is None:
        return True
    if isinstance(value, tuple | list):
        if value and kind is tuple and type(value[0]) is float:
            # A vector. Every item is a float of bounded size, so that only NaN can spoil the sum.
            return math.isfinite(sum(value))
        return all(map(_finite, value))
    if isinstance(value, msgspec.Struct):
        return all(_finite(getattr(value, name)) for name in value.__struct_fields__)
    if isinstance(value, dict):
        return all(map(_finite, value.values()))
    return True
