"""tc-netem's own words, as its users type them: told in the words of a SPEC, never guessed.

`delay 100ms 20ms` is `uniform:80,120`, `loss 1%` is `loss:1%`. A SPEC has no blanks within a word, so tc's grammar
cannot be mistaken for one.
"""

import re

_NUMBER = re.compile(r"\d")
_TC_NAMES = (
    "delay",
    "loss",
    "duplicate",
    "corrupt",
    "rate",
    "reorder",
    "slot",
    "limit",
    "gap",
    "distribution",
    "ecn",
)
_DISTRIBUTIONS = {"normal": "gaussian", "pareto": "pareto", "paretonormal": "paretonormal"}
_TIME = re.compile(r"(\d+(?:\.\d+)?)(us|usec|usecs|ms|msec|msecs|s|sec|secs)?\Z")
_MS = {None: 1e-3, "us": 1e-3, "usec": 1e-3, "usecs": 1e-3, "ms": 1.0, "msec": 1.0, "msecs": 1.0}


def looks_like_tc(name: str, rest: str) -> bool:
    """Whether a word that ended without a colon begins tc's grammar; `rest` is what follows it."""
    follows = rest.split(maxsplit=1)
    if name not in _TC_NAMES or not rest[:1].isspace() or not follows:
        return False
    known = ("random", "state", "gemodel", "distribution", *_DISTRIBUTIONS)
    return bool(_NUMBER.match(follows[0])) or follows[0] in known


def in_our_words(text: str) -> str:
    """The SPEC of tc's words; empty where there is none for all of them."""
    tokens = text.split()
    found: dict[str, str] = {}
    while tokens:
        name = tokens.pop(0)
        values = [tokens.pop(0)] if name == "slot" and tokens[:1] == ["distribution"] else []
        while tokens and tokens[0] not in _TC_NAMES:
            values.append(tokens.pop(0))
        said = _said(name, values, found)
        if not said:
            return ""
        found[name] = said
    return " ".join(said for name, said in found.items() if name not in ("distribution", "gap"))


def _said(name: str, values: list[str], found: dict[str, str]) -> str:
    if name == "delay":
        return _delay(values)
    if name == "distribution":
        return _distribution(values, found)
    if name == "gap":
        return _gap(values, found)
    if name == "loss":
        return _loss(values)
    if name in ("duplicate", "corrupt") and 1 <= len(values) <= 2:
        return f"{name}:{','.join(map(_percent, values))}"
    if name in ("rate", "limit") and len(values) == 1:
        return f"{name}:{values[0]}"
    if name == "reorder" and 1 <= len(values) <= 2:
        return f"reorder:gap(1,{','.join(map(_percent, values))})"
    return _slot(values) if name == "slot" else ""


def _slot(values: list[str]) -> str:
    bounds: dict[str, str] = {}
    while len(values) > 2 and values[-2] in ("packets", "bytes") and values[-1].isdigit():
        bounds[values[-2]], values = values[-1], values[:-2]
    told = [bounds["packets"]] if "packets" in bounds else []
    told += [f"{bounds['bytes']}B"] if "bytes" in bounds else []
    if values[:1] == ["distribution"]:
        fits = len(values) == 4 and values[1] in _DISTRIBUTIONS
        times = [_in_ms(value) for value in values[2:]]
        if not fits or None in times:
            return ""
        return f"slot:{values[1]}({','.join([*(f'{ms:g}' for ms in times), *told])})"
    times = [_in_ms(value) for value in values]
    if not 1 <= len(values) <= 2 or None in times:
        return ""
    if len(times) == 1 and "packets" in bounds:
        times *= 2
    return f"slot:{','.join([*(f'{ms:g}' for ms in times), *told])}"


def _delay(values: list[str]) -> str:
    times = [_in_ms(value) for value in values[:2]]
    if not 1 <= len(values) <= 3 or None in times:
        return ""
    mean, jitter = times[0] or 0.0, (times[1] or 0.0) if len(times) > 1 else 0.0
    if not jitter:
        return f"constant:{mean:g}"
    tail = f",{_percent(values[2])}" if len(values) > 2 else ""
    return f"uniform:{max(0.0, mean - jitter):g},{mean + jitter:g}{tail}"


def _distribution(values: list[str], found: dict[str, str]) -> str:
    """Puts its name in the place of the uniform word that stands before it."""
    before = found.get("delay", "")
    if len(values) != 1 or not before.startswith("uniform:"):
        return ""
    if values[0] == "uniform":
        return before
    if values[0] not in _DISTRIBUTIONS:
        return ""
    low, high, *tail = before.removeprefix("uniform:").split(",")
    mean, spread = (float(low) + float(high)) / 2, (float(high) - float(low)) / 2
    found["delay"] = ",".join([f"{_DISTRIBUTIONS[values[0]]}:{mean:g}", f"{spread:g}", *tail])
    return found["delay"]


def _gap(values: list[str], found: dict[str, str]) -> str:
    if len(values) != 1 or not values[0].isdigit() or "reorder" not in found:
        return ""
    found["reorder"] = found["reorder"].replace("gap(1,", f"gap({values[0]},", 1)
    return found["reorder"]


def _loss(values: list[str]) -> str:
    if values[:1] == ["random"]:
        values = values[1:]
    if values[:1] in (["gemodel"], ["state"]):
        form = "gilbert" if values[0] == "gemodel" else "state"
        return f"loss:{form}({','.join(map(_percent, values[1:]))})" if len(values) > 2 else ""
    return f"loss:{','.join(map(_percent, values))}" if 1 <= len(values) <= 2 else ""


def _percent(word: str) -> str:
    return word if word.endswith("%") else f"{word}%"


def _in_ms(word: str) -> float | None:
    found = _TIME.match(word)
    return None if found is None else float(found.group(1)) * _MS.get(found.group(2), 1e3)
