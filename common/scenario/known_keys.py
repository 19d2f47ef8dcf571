"""What is meant where a key is unknown, or its value is of no use: the nearest keys, and the unit."""

import difflib
import re
import typing

from msgspec import Struct

from farhand.common.scenario.reader import name_key

_UNKNOWN = re.compile(r"unknown field `(.*?)`(?: - at `\$\.?(.*?)`)?\Z", re.DOTALL)
_NUMBER = re.compile(r"Expected `(?:float|int)[^`]*`.* - at `\$\.?(.*?)`\Z", re.DOTALL)
_UNIT = re.compile(r"\((mm|m|s|ms|rad|Hz|kg|N|N m|m/s|rad/s|m/s\^2|rad/s\^2)\)")
_SHOWN = 40


def explained(text: str, root: type[Struct], within: str = "", hint: str = "") -> str:
    """msgspec's complaint for people: the key in front, what is expected with its unit, or what there is instead.

    Args:
        text: of the error.
        root: the type that was read.
        within: dotted name of the table that was read; empty: the whole.
        hint: what is said in place of the known keys.
    """
    said, unit = name_key(text, within), _unit(text, root)
    if unit:
        said = said.replace(" number", f" number ({unit})", 1)
    return said + (hint or there_are(text, root))


def there_are(text: str, root: type[Struct]) -> str:
    """`; is gamma meant? there are angular_limit, d_min, ...` for msgspec's complaint about an unknown field; empty for
    any other.

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
    keys = _keys(table)
    close = difflib.get_close_matches(key, keys, n=1)
    elsewhere = _elsewhere(key, root) if not path and key not in keys else ""
    meant = elsewhere or (f"; is {close[0]} meant?" if close else "")
    known = ", ".join(sorted(keys)[:_SHOWN])
    return f"{meant}{'' if meant else ';'} there are {known}" if keys else "; there are none"


def nearest_first(key: str, known: list[str]) -> list[str]:
    """The known keys, those that are most like `key` first; of many only the nearest."""
    close = difflib.get_close_matches(key, known, n=len(known) or 1, cutoff=0.0)
    return [*close, *(each for each in known if each not in close)][:_SHOWN]


def _unit(text: str, root: type[Struct]) -> str:
    """The unit of a number, as the docstring of its section has it; empty where none is told."""
    found = _NUMBER.search(text)
    if found is None:
        return ""
    *path, key = re.sub(r"\[.*?\]", "", found.group(1) or "").split(".")
    if key.endswith("_hz"):
        return "Hz"
    table = _at(root, ".".join(path))
    # Newer Pythons take the indentation out of docstrings.
    entry = rf"^ *(?:\w+, )*{key}(?:, \w+)*: (.*?)(?=^ *\w+(?:, \w+)*: |\Z)"
    told = re.search(entry, _doc(table), re.DOTALL | re.MULTILINE)
    unit = _UNIT.search(told.group(1)) if told is not None and key else None
    return str(unit.group(1)) if unit is not None else ""


def _doc(table: type[Struct] | None) -> str:
    return (table.__doc__ or "") if table is not None else ""


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
