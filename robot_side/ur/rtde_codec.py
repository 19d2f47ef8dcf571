"""The packages of RTDE, protocol version 2: framing, types and recipes.

A package is its size (uint16, header included), its kind (uint8) and a payload, all big-endian; a data package is the
recipe's number (uint8) and the values of its variables in order. Source: Universal Robots, "Real-Time Data Exchange
(RTDE) Guide".
"""

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

VERSION, URCONTROL, TEXT, DATA = ord("V"), ord("v"), ord("M"), ord("U")
OUTPUTS, INPUTS, START, PAUSE = ord("O"), ord("I"), ord("S"), ord("P")
HEADER = struct.Struct(">HB")
MAX_PACKAGE = 65_535

Value: TypeAlias = "bool | int | float | Sequence[float] | Sequence[int]"

FORMATS = {
    "BOOL": "?",
    "UINT8": "B",
    "UINT32": "I",
    "UINT64": "Q",
    "INT32": "i",
    "DOUBLE": "d",
    "VECTOR3D": "3d",
    "VECTOR6D": "6d",
    "VECTOR6INT32": "6i",
    "VECTOR6UINT32": "6I",
}
NOT_FOUND, IN_USE = "NOT_FOUND", "IN_USE"


class BrokenStreamError(ValueError):
    """What came is no sequence of packages; the connection is of no further use."""


@dataclass(frozen=True, slots=True)
class Package:
    """One package: its kind and its payload."""

    kind: int
    payload: bytes


def pack(kind: int, payload: bytes = b"") -> bytes:
    """The bytes of a package."""
    return HEADER.pack(HEADER.size + len(payload), kind) + payload


def take(buffer: bytearray) -> list[Package]:
    """All whole packages at the beginning of `buffer`, which loses them; raises BrokenStreamError."""
    found = []
    while len(buffer) >= HEADER.size:
        size, kind = HEADER.unpack_from(buffer)
        if size < HEADER.size:
            raise BrokenStreamError(f"a package of {size} bytes")
        if len(buffer) < size:
            break
        found.append(Package(kind, bytes(buffer[HEADER.size : size])))
        del buffer[:size]
    return found


class Recipe:
    """Variables that travel together.

    Args:
        number: of the recipe, 1 to 255.
        names, types: of its variables, in order.
    """

    def __init__(self, number: int, names: Sequence[str], types: Sequence[str]) -> None:
        self.number, self.names, self.types = number, tuple(names), tuple(types)
        self._struct = struct.Struct(">B" + "".join(FORMATS[each] for each in types))
        self._lengths = [int(FORMATS[each][0]) if FORMATS[each][0].isdigit() else 0 for each in types]

    def pack(self, values: Sequence[Value]) -> bytes:
        """The payload of a data package; a vector is a sequence."""
        flat: list[Value] = []
        for value, length in zip(values, self._lengths, strict=True):
            if length:
                flat.extend(value)  # type: ignore[arg-type]
            else:
                flat.append(value)
        return self._struct.pack(self.number, *flat)

    def unpack(self, payload: bytes) -> list[Value]:
        """The values of a data package's payload; raises BrokenStreamError where it does not fit the recipe."""
        try:
            number, *flat = self._struct.unpack(payload)
        except struct.error as error:
            raise BrokenStreamError(f"a data package that does not fit its recipe: {error}") from None
        if number != self.number:
            raise BrokenStreamError(f"a data package of recipe {number}, not {self.number}")
        values: list[Value] = []
        at = 0
        for length in self._lengths:
            values.append(flat[at : at + length] if length else flat[at])
            at += length or 1
        return values
