"""An obstacle by the words of a command line, as the table that a scenario would have."""

from typing import Any

from farhand.common.errors import InputError

_SIZES = {
    "sphere": ("radius",),
    "capsule": ("radius", "half_length"),
    "box": ("half_extents",),
    "plane": (),
    "mesh": ("scale",),
}
"""Keys that --size fills, shape by shape."""


def obstacle_table(
    name: str, shape: str, at: str, size: str, *, orientation: str = "", normal: str = "", velocity: str = ""
) -> dict[str, Any]:
    """The table; raises InputError for words that make no numbers. What they mean is judged as a scenario's.

    Args:
        name: id.
        shape: a kind, or `mesh:FILE`.
        at: position (m).
        size: of the shape (m).
        orientation, normal, velocity: as a scenario has them; empty: left out.
    """
    kind, _, file = shape.partition(":")
    if kind not in _SIZES or (file and kind != "mesh"):
        raise InputError(f"--shape {shape!r}: expected sphere, capsule, box, plane or mesh:FILE")
    if not name:
        raise InputError("--id: an obstacle needs a name")
    if not at:
        raise InputError("--at: expected X,Y,Z, where it is, in m")
    table: dict[str, Any] = {"id": name, "position": _numbers("--at", at, 3)}
    told: dict[str, Any] = {"kind": kind}
    if kind == "mesh":
        told["file"] = file
    told |= _sizes(kind, size)
    for key, words, count in (
        ("orientation", orientation, 4),
        ("normal", normal, 3),
        ("velocity", velocity, 3),
    ):
        if words:
            table[key] = _numbers(f"--{key}", words, count)
    return table | {"shape": told}


def _sizes(kind: str, size: str) -> dict[str, Any]:
    keys = _SIZES[kind]
    if kind == "mesh" and not size:
        return {}
    if not keys:
        if size:
            raise InputError("--size: a plane has none")
        return {}
    if keys == ("half_extents",):
        return {"half_extents": _numbers("--size", size, 3)}
    return dict(zip(keys, _numbers("--size", size, len(keys), ",".join(keys)), strict=True))


def _numbers(option: str, words: str, count: int, meaning: str = "") -> list[float]:
    try:
        found = [float(word) for word in words.split(",")]
    except ValueError:
        found = []
    if len(found) != count:
        what = f", {meaning}" if meaning else ""
        number = "a number" if count == 1 else f"{count} numbers with commas between"
        raise InputError(f"{option} {words!r}: expected {number}{what}")
    return found
