"""What there is where an unknown key was said, the nearest first."""

import difflib
import re
import typing

from msgspec import Struct

_UNKNOWN = re.compile(r"unknown field `(.*?)`(?: - at `\$\.?(.*?)`)?\Z", re.DOTALL)
_SHOWN = 40


def there_are(text: str, root: type[Struct]) -> str:
    """`; there are gamma, horizon, ...` for msgspec's complaint about an unknown field; empty for any other.

    Args:
        text: of the error.
        root: the type that was read.
    """
    found = _UNKNOWN.search(text)
    if found is None:
        return ""
    key, path = found.group(1), found.group(2) or ""
    table = _at(root, path)
    if table is None:
        return ""
    keys = nearest_first(key, _keys(table))
    meant = _elsewhere(key, root) if not path and key not in keys else ""
    return f"{meant}; there are {', '.join(keys)}" if keys else "; there are none"


def nearest_first(key: str, known: list[str]) -> list[str]:
    """The known keys, those that are most like `key` first; of many only the nearest."""
    close = difflib.get_close_matches(key, known, n=len(known) or 1, cutoff=0.0)
    return [*close, *(each for each in known if each not in close)][:_SHOWN]


def _at(root: type[Struct], path: str) -> type[Struct] | None:
    """The type of the table at msgspec's dotted path."""
    table: object = root
    for part in filter(None, re.sub(r"\[.*?\]", "", path).split(".")):
        if not _is_table(table):
            return None
        table = _table_in(typing.get_type_hints(table).get(part))
    return table if _is_table(table) else None


def _table_in(hint: object) -> object:
    """The struct that a hint names, or has for its items."""
    if _is_table(hint):
        return hint
    return next((found for arg in typing.get_args(hint) if _is_table(found := _table_in(arg))), None)


def _is_table(kind: object) -> typing.TypeGuard[type[Struct]]:
    return isinstance(kind, type) and issubclass(kind, Struct)


def _keys(table: type[Struct]) -> list[str]:
    return [name for name in table.__struct_fields__ if name != "own"]


def _elsewhere(key: str, root: type[Struct]) -> str:
    """`; is controller.gamma meant?` where a section has that key."""
    hints = typing.get_type_hints(root)
    found = [
        f"{name}.{key}" for name in _keys(root) if _is_table(section := hints[name]) and key in _keys(section)
    ]
    return f"; is {' or '.join(found)} meant?" if found else ""
