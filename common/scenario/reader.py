"""From nested tables to typed settings, with messages that name the key."""

import math
import re
from typing import Any

_TYPES = {
    "float": "a number",
    "int": "a whole number",
    "str": "text",
    "bool": "true or false",
    "array": "a list",
    "object": "a table",
}


def name_key(text: str, within: str = "") -> str:
    """msgspec's message with the key in front: `robot.radius: expected a number >= 0.0`.

    Args:
        text: of the error.
        within: dotted name of the table that was read; empty: the whole.
    """
    text = " ".join(text.splitlines())  # a key that nobody knows may hold anything
    message, separator, path = text.partition(" - at `$")
    message = _in_words(message[:1].lower() + message[1:])
    key = path.rstrip("`").lstrip(".") if separator else ""
    place = ".".join(part for part in (within, key) if part)
    return f"{place}: {message}" if place else message


def _in_words(message: str) -> str:
    """The same without the names of Python's types."""
    message = message.removeprefix("object contains ")
    if not message.startswith("expected "):
        return message
    message = message.replace(" | null", "")
    return re.sub(r"`(\w+)`", lambda found: _TYPES.get(found.group(1), found.group(0)), message)


def non_finite_key(value: Any, path: str = "") -> str:
    """Dotted name of the first number that is infinite or not a number; empty if there is none."""
    if isinstance(value, float) and not math.isfinite(value):
        return path
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in items:
        place = f"{path}[{key}]" if isinstance(value, list) else f"{path}.{key}" if path else str(key)
        found = non_finite_key(inner, place)
        if found:
            return found
    return ""


def without_nulls(value: Any) -> Any:
    """The same nested tables and lists without keys that hold None, which TOML cannot say."""
    if isinstance(value, dict):
        return {key: without_nulls(v) for key, v in value.items() if v is not None}
    if isinstance(value, list | tuple):
        return [without_nulls(v) for v in value]
    return value
