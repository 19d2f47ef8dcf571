"""URScript, translated into Python: functions and threads become generators that yield once a controller cycle.

Enough of the language for the programs that clients upload: def, thread, sec, if, while, return, break, continue,
global and local variables, lists and poses, run, kill, join, critical sections, calls by position and by name. Names
get a prefix and nothing else of the text reaches the Python code: a program calls only what the emulator offers it.
"""

import itertools
from collections.abc import Callable, Iterable
from types import CodeType
from typing import NamedTuple

from farhand.ur_emulator.script_words import ScriptError, Token, tokens

_ENDS = ("end", "elif", "else")
_RESERVED = {
    *_ENDS, "def", "thread", "sec", "if", "while", "return", "break", "continue", "pass", "halt", "kill", "join",
    "global", "local", "and", "or", "xor", "not", "enter_critical", "exit_critical",
}  # fmt: skip
_COMPARISONS = ("==", "!=", "<", ">", "<=", ">=")
MOST_NESTED = 60


class Scope:
    """What a function calls its own: parameters and locals; `assigned` are all names that it gives values."""

    def __init__(self, parameters: Iterable[str]) -> None:
        self.own = set(parameters)
        self.assigned: set[str] = set()


class Translator:
    """One program.

    Args:
        text: the program: one def around all, or statements.
        waits: names of the emulator's functions that take time; they are generators.
        offered: names of all functions of the emulator.
    """

    def __init__(self, text: str, waits: Iterable[str], offered: Iterable[str]) -> None:
        self._tokens, self._at = tokens(text), 0
        self._waits, self._offered = set(waits), set(offered)
        self._defined = self._find_defined()
        self._globals: set[str] = set()
        self._functions: list[tuple[str, list[str], list[str], Scope]] = []
        self._depth = 0
        self.unknown: set[str] = set()

    def translate(self) -> tuple[str, str, bool]:
        """Python code, the name of the function to begin with, and whether it is a secondary program."""
        first = self._tokens[0]
        if first.text not in ("def", "sec"):
            raise ScriptError(f"line {first.line}: a program begins with def or sec, not {first.text!r}")
        main = self._function(top=True)
        if self._peek().kind != "over":
            raise ScriptError(
                f"line {self._peek().line}: {self._peek().text!r} stands behind the program's end"
            )
        lines = []
        for name, parameters, body, scope in self._functions:
            shared = sorted((scope.assigned - scope.own) & self._globals)
            lines.append(f"def f_{name}({', '.join('v_' + each for each in parameters)}):")
            lines += [f"    global {', '.join('v_' + each for each in shared)}"] if shared else []
            lines += ["    " + line for line in body] + ["    if 0: yield"]
        return "\n".join(lines), main, first.text == "sec"

    def _find_defined(self) -> set[str]:
        pairs = itertools.pairwise(self._tokens)
        return {b.text for a, b in pairs if a.text in ("def", "thread", "sec") and b.kind == "name"}

    def _peek(self) -> Token:
        return self._tokens[self._at]

    def _next(self) -> Token:
        token = self._tokens[self._at]
        self._at += token.kind != "over"
        return token

    def _is(self, *texts: str) -> bool:
        token = self._peek()
        return token.kind in ("name", "sign") and token.text in texts

    def _take(self, *texts: str) -> bool:
        if not self._is(*texts):
            return False
        self._next()
        return True

    def _expect(self, text: str) -> None:
        token = self._next()
        if token.text != text or token.kind not in ("name", "sign"):
            raise ScriptError(f"line {token.line}: expected {text!r}, got {token.text or 'the end'!r}")

    def _name(self) -> str:
        token = self._next()
        if token.kind != "name":
            raise ScriptError(f"line {token.line}: expected a name, got {token.text or 'the end'!r}")
        return token.text

    def _function(self, top: bool = False) -> str:
        self._next()
        name = self._name()
        self._expect("(")
        parameters: list[str] = []
        while not self._is(")"):
            parameters.append(self._name())
            if not self._take(","):
                break
        self._expect(")")
        self._expect(":")
        scope = Scope(parameters)
        body = self._block(scope, top)
        self._expect("end")
        self._functions.append((name, parameters, body, scope))
        return name

    def _block(self, scope: Scope, top: bool) -> list[str]:
        """Statements up to what ends them, as lines of Python."""
        self._depth += 1
        if self._depth > MOST_NESTED:
            raise ScriptError(f"line {self._peek().line}: nested too deeply")
        lines: list[str] = []
        while not self._is(*_ENDS):
            if self._peek().kind == "over":
                raise ScriptError(f"line {self._peek().line}: an end is missing")
            lines += self._statement(scope, top)
        self._depth -= 1
        return lines or ["pass"]

    def _statement(self, scope: Scope, top: bool) -> list[str]:
        token = self._peek()
        if token.text in ("def", "thread", "sec") and token.kind == "name":
            self._function()
            return ["pass"]
        simple: dict[str, Callable[[], list[str]]] = {
            "while": lambda: self._while(scope, top),
            "if": lambda: self._if(scope, top),
            "return": lambda: self._return(token),
            "break": lambda: ["break"],
            "continue": lambda: ["continue"],
            "pass": lambda: ["pass"],
            "halt": lambda: ["yield from b_halt()"],
            "enter_critical": lambda: ["b_enter_critical()"],
            "exit_critical": lambda: ["b_exit_critical()"],
            "kill": lambda: [f"b_kill({self._expression()})"],
            "join": lambda: [f"yield from b_join({self._expression()})"],
            "global": lambda: self._declaration(scope, shared=True),
            "local": lambda: self._declaration(scope, shared=False),
        }
        if token.kind == "name" and token.text in simple:
            self._next()
            return simple[token.text]()
        return self._assignment(scope, top)

    def _while(self, scope: Scope, top: bool) -> list[str]:
        condition = self._expression()
        self._expect(":")
        body = self._block(scope, top)
        self._expect("end")
        return [f"while {condition}:", "    if b_spent(): yield", *("    " + line for line in body)]

    def _if(self, scope: Scope, top: bool) -> list[str]:
        lines, word = [], "if"
        while True:
            condition = f" {self._expression()}" if word != "else" else ""
            self._expect(":")
            lines += [f"{word}{condition}:", *("    " + line for line in self._block(scope, top))]
            token = self._next()
            if token.text == "end":
                return lines
            if word == "else":
                raise ScriptError(f"line {token.line}: {token.text!r} behind else")
            word = token.text

    def _return(self, token: Token) -> list[str]:
        after = self._peek()
        bare = after.line != token.line or self._is(*_ENDS)
        return ["return None" if bare else f"return {self._expression()}"]

    def _declaration(self, scope: Scope, *, shared: bool) -> list[str]:
        name = self._name()
        scope.assigned.add(name)
        if shared:
            self._globals.add(name)
        else:
            scope.own.add(name)
        return [f"v_{name} = {self._value()}"] if self._take("=") else [f"v_{name} = None"]

    def _assignment(self, scope: Scope, top: bool) -> list[str]:
        start = self._at
        if self._peek().kind == "name":
            name = self._name()
            if self._take("="):
                scope.assigned.add(name)
                if top and name not in scope.own:
                    self._globals.add(name)
                return [f"v_{name} = {self._value()}"]
            if self._is("["):
                self._next()
                index = self._expression()
                self._expect("]")
                if self._take("="):
                    return [f"v_{name}[{index}] = {self._value()}"]
        self._at = start
        return [self._expression()]

    def _value(self) -> str:
        """A right-hand side; lists are values, and copied."""
        return f"b_copied({self._expression()})"

    def _expression(self) -> str:
        self._depth += 1
        if self._depth > MOST_NESTED:
            raise ScriptError(f"line {self._peek().line}: nested too deeply")
        left = self._conjunction()
        while self._is("or", "xor"):
            word = self._next().text
            right = self._conjunction()
            left = f"({left} or {right})" if word == "or" else f"(bool({left}) != bool({right}))"
        self._depth -= 1
        return left

    def _conjunction(self) -> str:
        left = self._negation()
        while self._take("and"):
            left = f"({left} and {self._negation()})"
        return left

    def _negation(self) -> str:
        negations = 0
        while self._take("not"):
            negations += 1
        inner = self._comparison()
        return f"(not {inner})" if negations % 2 else inner

    def _comparison(self) -> str:
        left = self._sum()
        while self._is(*_COMPARISONS):
            left = f"({left} {self._next().text} {self._sum()})"
        return left

    def _sum(self) -> str:
        left = self._product()
        while self._is("+", "-"):
            left = f"({left} {self._next().text} {self._product()})"
        return left

    def _product(self) -> str:
        left = self._signed()
        while self._is("*", "/", "%"):
            left = f"({left} {self._next().text} {self._signed()})"
        return left

    def _signed(self) -> str:
        sign = ""
        while self._is("-", "+"):
            sign = "" if (self._next().text == "-") == (sign == "-") else "-"
        return f"({sign}{self._postfix()})" if sign else self._postfix()

    def _postfix(self) -> str:
        value = self._primary()
        while self._is("[") and not self._peek().first:
            self._next()
            value = f"{value}[{self._expression()}]"
            self._expect("]")
        return value

    def _primary(self) -> str:
        token = self._next()
        if token.kind == "number":
            return token.text if not token.text.isdigit() else str(int(token.text))
        if token.kind == "string":
            return repr(token.text[1:-1])
        if token.text == "(":
            inner = self._expression()
            self._expect(")")
            return f"({inner})"
        if token.text == "[":
            return f"[{self._list()}]"
        if token.kind != "name":
            raise ScriptError(f"line {token.line}: expected a value, got {token.text or 'the end'!r}")
        return self._word(token)

    def _word(self, token: Token) -> str:
        if token.text in ("True", "False"):
            return token.text
        if token.text in _RESERVED:
            raise ScriptError(f"line {token.line}: expected a value, got {token.text!r}")
        if token.text == "run":
            name = self._name()
            self._expect("(")
            self._expect(")")
            if name not in self._defined:
                raise ScriptError(f"line {token.line}: there is no thread {name!r}")
            return f"b_run(f_{name})"
        if token.text == "p" and self._is("[") and not self._peek().first:
            self._next()
            return f"b_pose({self._list()})"
        if self._is("(") and not self._peek().first:
            return self._call(token)
        return f"v_{token.text}"

    def _list(self) -> str:
        values = []
        while not self._is("]"):
            values.append(self._expression())
            if not self._take(","):
                break
        self._expect("]")
        return ", ".join(values)

    def _call(self, token: Token) -> str:
        self._next()
        arguments = []
        while not self._is(")"):
            by_name = self._peek().kind == "name" and self._tokens[self._at + 1].text == "="
            key = self._name() if by_name else ""
            if by_name:
                self._next()
            value = self._expression()
            arguments.append(f"{'v_' if token.text in self._defined else ''}{key}={value}" if key else value)
            if not self._take(","):
                break
        self._expect(")")
        listed = ", ".join(arguments)
        if token.text in self._defined:
            return f"(yield from f_{token.text}({listed}))"
        if token.text in self._waits:
            return f"(yield from b_{token.text}({listed}))"
        if token.text in self._offered:
            return f"b_{token.text}({listed})"
        self.unknown.add(token.text)
        return f"b_missing({token.text!r})"


class Translation(NamedTuple):
    """A program that can be run: code that defines its functions, where it begins, what it lacks."""

    code: CodeType
    main: str
    secondary: bool
    unknown: frozenset[str]


def translate(text: str, waits: Iterable[str], offered: Iterable[str]) -> Translation:
    """A program as Python; raises ScriptError with the line.

    Args:
        text: URScript.
        waits: the emulator's functions that take time.
        offered: all functions of the emulator.
    """
    translator = Translator(text, waits, offered)
    source, main, secondary = translator.translate()
    try:
        code = compile(source, "<urscript>", "exec")
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise ScriptError(f"it cannot be translated: {error}") from None
    return Translation(code, main, secondary, frozenset(translator.unknown))
