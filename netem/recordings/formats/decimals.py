"""Numbers as people write them: 15.2 and 15,2, 1,234.5 and 1.234,5. Judged by a whole column, never by a cell."""

import re

from farhand.netem.recordings.formats.base import Decimal, TraceText

_GROUPS_BY_COMMA = re.compile(r"-?[1-9]\d{0,2}(?:,\d{3})+(?:\.\d+)?\Z")
_GROUPS_BY_POINT = re.compile(r"-?[1-9]\d{0,2}(?:\.\d{3})+(?:,\d+)?\Z")


def decimal_of(words: list[str], said: Decimal | None, what: str, text: TraceText) -> Decimal:
    """How a column writes its fractions; raises TraceError where 1,234 could be either.

    Args:
        words: its cells.
        said: what the caller says.
        what: is in the column, such as "delay".
        text: the file.
    """
    if said is not None:
        return said
    with_comma = [word for word in words if "," in word]
    if not with_comma:
        return "point"
    commas = any(not _GROUPS_BY_COMMA.match(word) for word in with_comma)
    points = any("." in word and not _GROUPS_BY_POINT.match(word) for word in words)
    if commas and points:
        text.fail(
            f"the column of the {what} has decimal commas and decimal points; say which: decimal=comma or point"
        )
    if not (commas or points):
        text.fail(
            f"{with_comma[0]!r} in the column of the {what}: is the comma a decimal comma, or does it part thousands? "
            "Say decimal=comma or decimal=point (--decimal)"
        )
    found: Decimal = "comma" if commas else "point"
    text.how(f"decimals of the {what}", f"{found} (all cells agree)")
    return found


def plain(word: str, decimal: Decimal) -> str:
    """A number with a decimal point and nothing between its thousands; other words as they are."""
    if decimal == "comma":
        if "," in word or _GROUPS_BY_POINT.match(word):
            return word.replace(".", "").replace(",", ".", 1)
        return word
    return word.replace(",", "") if "," in word and _GROUPS_BY_COMMA.match(word) else word
