"""Where a package's files lie, and what a name that is not there may have meant."""

import difflib
import importlib.util
from collections.abc import Iterable
from pathlib import Path


def installed(package: str) -> Path | None:
    """The folder of an installed Python package, which is not imported for that."""
    found = importlib.util.find_spec(package) if package.isidentifier() else None
    return Path(found.origin).parent if found is not None and found.origin else None


def nearest(name: str, known: Iterable[str]) -> str:
    """What may have been meant: the nearest names, or all."""
    known = sorted(known)
    close = difflib.get_close_matches(name, known, n=3, cutoff=0.5)
    return f"nearest are {', '.join(close)}" if close else f"there are {', '.join(known[:12])}"
