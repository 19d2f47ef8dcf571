"""The words of a program in URScript."""

import re
from typing import NamedTuple

_TOKEN = re.compile(
    r"""(?P<blank>[ \t\r]+|\#[^\n]*)|(?P<newline>\n)|(?P<number>(\d+\.\d*|\.\d+|\d+)([eE][+-]?\d+)?)
    |(?P<string>"[^"\n]*"|'[^'\n]*')|(?P<name>[A-Za-z_]\w*)|(?P<sign>==|!=|<=|>=|[-+*/%<>=()\[\],:])""",
    re.VERBOSE,
)


class ScriptError(ValueError):
    """A program that cannot be run; the text says where and why."""


class Token(NamedTuple):
    """A word of the program; `first` of its line or not."""

    kind: str
    text: str
    line: int
    first: bool


def tokens(text: str) -> list[Token]:
    """The words of a program; raises ScriptError."""
    found, at, line, first = [], 0, 1, True
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            raise ScriptError(f"line {line}: {text[at]!r} is not understood")
        at, kind = match.end(), str(match.lastgroup)
        if kind == "newline":
            line, first = line + 1, True
        elif kind != "blank":
            found.append(Token(kind, match.group(kind), line, first))
            first = False
    found.append(Token("over", "", line, True))
    return found
