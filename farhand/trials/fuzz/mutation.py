"""Mutations that keep an input what it is: a field of a map changed, dropped or added. All else the fuzzer does."""

import copy
import math
from typing import Any

import msgspec
import numpy as np

from farhand.trials.fuzz.target import Target

VALUES: tuple[Any, ...] = (
    None, True, False, 0, 1, -1, 7, 127, 128, 2**31 - 1, 2**32, 2**53, 2**62, 2**63 - 1, 2**64 - 1, -(2**63),
    0.0, -0.0, 0.1, 1.0, 2.0, 1e-300, 1e300, math.nan, math.inf, -math.inf, "", "x", "run", "estop", "none",
    "\ud7ff", "x" * 65, "x" * 600, b"", b"\xff" * 5, [], {}, [0.0, 0.0, 0.0], [math.nan] * 3, [[0.0] * 3] * 257,
)  # fmt: skip
FEW_BYTES = (
    b"\0",
    b"\xff",
    b"\x7f",
    b"\x80",
    b"\n",
    b"\r\n",
    b'"',
    b"[",
    b"{",
    b"1e999",
    b"nan",
    b"-1",
    b"\xc0\x80",
)


def mutated(target: Target, data: bytes, rng: np.random.Generator) -> bytes:
    """One input made of another: by its shape half of the time, where it still has one, else by its bytes."""
    head, body = data[: target.head], data[target.head :]
    if target.shape in ("map", "json") and rng.random() < 0.7:
        changed = by_shape(target, body, rng)
        if changed is not None:
            return head + changed
    return of_bytes(data, rng)[: target.longest]


def by_shape(target: Target, body: bytes, rng: np.random.Generator) -> bytes | None:
    """The same map with one value changed, dropped or added; None where it is no map."""
    protocol: Any = msgspec.msgpack if target.shape == "map" else msgspec.json
    try:
        found = protocol.decode(body)
        if not isinstance(found, dict) or not found:
            return None
        for _ in range(1 + _below(rng, 2)):
            _change(found, rng)
        changed: bytes = protocol.encode(found)
    except (msgspec.MsgspecError, ValueError, TypeError, RecursionError, OverflowError):
        return None
    return changed if len(changed) <= target.longest else None


def of_bytes(data: bytes, rng: np.random.Generator) -> bytes:
    """A few bytes flipped, cut, doubled, put in or taken out."""
    found = bytearray(data)
    for _ in range(1 + _below(rng, 3)):
        at, deed = _below(rng, len(found) + 1), _below(rng, 6)
        if deed == 0 and at < len(found):
            found[at] ^= 1 << _below(rng, 8)
        elif deed == 1 and at < len(found):
            found[at] = _below(rng, 256)
        elif deed == 2:
            del found[at : at + 1 + _below(rng, 8)]
        elif deed == 3:
            found[at:at] = FEW_BYTES[_below(rng, len(FEW_BYTES))]
        elif deed == 4:
            found[at:at] = found[at : at + 1 + _below(rng, 64)]
        else:
            del found[at:]
    return bytes(found)


def _below(rng: np.random.Generator, end: int) -> int:
    """A number from 0 on; many times as fast as `integers`."""
    return int(rng.random() * end)


def _any(rng: np.random.Generator) -> Any:
    """One of VALUES, of its own: a later change must not change them all."""
    return copy.deepcopy(VALUES[_below(rng, len(VALUES))])


def _change(found: dict[Any, Any], rng: np.random.Generator) -> None:
    place: Any = found
    while True:
        keys = list(place) if isinstance(place, dict) else range(len(place))
        if not keys:  # the last field is gone
            place["another"] = None
            return
        key = keys[_below(rng, len(keys))]
        inner = place[key]
        if not isinstance(inner, (dict, list)) or not inner or rng.random() < 0.3:
            break
        place = inner
    deed = rng.random()
    if deed < 0.7:
        place[key] = _value(place[key], rng)
    elif deed < 0.8 and isinstance(place, dict):
        del place[key]
    elif isinstance(place, list):
        place.append(place[key])
    else:
        place["another"] = _any(rng)


def _value(old: Any, rng: np.random.Generator) -> Any:
    if type(old) is int and rng.random() < 0.5:
        return max(-(2**63), min(2**64 - 1, old + (_below(rng, 7) - 3)))
    if type(old) is float and rng.random() < 0.5:
        return old * float(rng.normal()) * 10.0 ** (_below(rng, 7) - 3)
    return _any(rng)
