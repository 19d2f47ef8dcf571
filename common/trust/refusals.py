"""Whom Zenoh refused at a link and why, from its own log, in words for people and at a bearable rate.

Zenoh tells of what its TLS and its access control refuse in its log alone. A line of it that matters here is

    2026-11-25T10:25:34Z  WARN acc-0 ThreadId(05) zenoh_link_tls::unicast: peer sent no certificates. Hint: ...

or, for a message that access control kept back, two lines of one thread: who wanted to do what, then that it
was `intercepted` (the first alone is also written when permissions are looked up in advance).
"""

import re
from collections.abc import Callable

from farhand.common.trust.rare_lines import RareLines

LEVELS = "error,zenoh_link_tls=warn,zenoh::net::routing::interceptor=trace"
"""What Zenoh must be asked to log."""
MAX_NAMES = 1024
MAX_LINE = 65_536

_COLOUR = re.compile(rb"\x1b\[[0-9;]*m")
_LINE = re.compile(r"\d{4}-\d\d-\d\dT\S+Z +([A-Z]+) +(.*?ThreadId\(\d+\)) (?:([\w:]+): )?(.*)\Z")
_NAMED = re.compile(r"(\w+) on \S*CertCommonName\(([^)]*)\)")
_DENIED = re.compile(r"(\w+)(?: on \S+)? is unauthorized to ([A-Z][A-Za-z/ ]*?) \(ingress\) on (\S+)")
# Declarations that answer one of our own are kept back from lawful programs as well: nobody's attack.
_DEEDS = {
    "Put": "write",
    "Delete": "delete",
    "Declare Subscriber": "read",
    "Query": "ask",
    "Liveliness Token": "show itself as",
}
_HANDSHAKES = (
    ("sent no certificates", "it showed no certificate"),
    ("UnknownIssuer", "its certificate is of another authority"),
    ("BadSignature", "its certificate is of another authority"),
    ("certificate expired", "its certificate has ended (or a clock is wrong)"),
    ("Expired", "its certificate has ended (or a clock is wrong)"),
    ("not valid yet", "its certificate is not valid yet (or a clock is wrong)"),
    ("NotValidYet", "its certificate is not valid yet (or a clock is wrong)"),
    ("received fatal alert", "it does not trust this program's certificate"),
    ("corrupt message", "what it sent is not TLS"),
    ("handshake eof", "it hung up during the handshake"),
)


class Refusals:
    """Told of log lines and of the time; says what was refused.

    Args:
        say: takes a line for people.
    """

    def __init__(self, say: Callable[[str], None]) -> None:
        self._lines = RareLines(say)
        self._rest = b""
        self._names: dict[str, str] = {}
        self._wanted: dict[str, tuple[str, str, str]] = {}

    def feed(self, chunk: bytes, now_ns: int) -> bytes:
        """Take a piece of the log as it comes, cut anywhere; returns what in it is not Zenoh's."""
        if b"\x1b" in chunk:
            chunk = _COLOUR.sub(b"", chunk)
        *lines, self._rest = (self._rest + chunk).split(b"\n")
        others = []
        if len(self._rest) > MAX_LINE:  # not a line of Zenoh's
            others.append(self._rest)
            self._rest = b""
        for line in lines:
            if _is_routine(line):
                continue
            text = line.decode("utf-8", "replace")
            found = _LINE.match(text)
            if found is None:
                others.append(line + b"\n")
            else:
                self._take(found[1], found[2], found[3] or "", found[4], now_ns)
        return b"".join(others)

    def tick(self, now_ns: int) -> None:
        """Let time act: say the counts that have waited long enough."""
        self._lines.tick(now_ns)

    def _take(self, level: str, thread: str, target: str, text: str, now_ns: int) -> None:
        if text.startswith("Msg intercepted"):
            zid, deed, key = self._wanted.pop(thread, ("", "", ""))
            if deed:
                name = self._names.get(zid, "somebody")
                self._lines.note(f"{name} {deed}", f"refused: {name} may not {deed} {key}", now_ns)
        elif "is unauthorized to" in text:
            named = _NAMED.search(text)
            if named is not None and len(self._names) < MAX_NAMES:
                self._names[named[1]] = named[2]
            found = _DENIED.search(text)
            if found is not None:
                self._wanted[thread] = found[1], _DEEDS.get(found[2], ""), found[3]
        elif target.startswith("zenoh_link_tls") and level in ("WARN", "ERROR"):
            for word, meaning in _HANDSHAKES:
                if word in text:
                    self._lines.note(word, f"refused a connection: {meaning}", now_ns)
                    return
            text = text.partition(" Hint:")[0]
            self._lines.note(text, f"refused a connection: {text}", now_ns)


def _is_routine(line: bytes) -> bool:
    """Whether a line says that something was let through: nearly all do, so that this is looked at first."""
    return b" is authorized to " in line and b"TRACE" in line[:40] and line[:2] == b"20"
