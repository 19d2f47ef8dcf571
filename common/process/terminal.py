"""Terminals that know few letters, and those that are gone: what is printed never ends a program."""

import codecs
import sys
from typing import Any

HANDLER = "farhand"
_PLAIN = {
    "–": "-",
    "—": "-",
    "−": "-",
    "…": "...",
    "±": "+-",
    "µ": "u",
    "μ": "u",
    "·": "*",
    "×": "x",
    "²": "2",
    "°": " deg",
    "≤": "<=",
    "≥": ">=",
    "→": "->",
    "✓": "+",
    "✗": "x",
    "σ": "sigma",
    "“": '"',
    "”": '"',
    "‘": "'",
    "’": "'",
    "•": "*",
    "━": "-",
    "─": "-",
    "│": "|",
}


def plain(error: UnicodeError) -> tuple[str, int]:
    """An error handler for encoding: the nearest letters that every terminal has, else `?`."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    letters = error.object[error.start : error.end]
    return "".join(_PLAIN.get(letter, "?") for letter in letters), error.end


def spare_the_terminal() -> None:
    """Have what the terminal cannot show written in plain letters, instead of an exception."""
    codecs.register_error(HANDLER, plain)
    for stream in (sys.stdout, sys.stderr):
        reconfigure: Any = getattr(stream, "reconfigure", None)
        if reconfigure is not None and getattr(stream, "errors", HANDLER) in ("strict", "surrogateescape"):
            reconfigure(errors=HANDLER)
