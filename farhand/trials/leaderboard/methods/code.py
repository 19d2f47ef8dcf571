"""Which version of a method from outside made a row."""

import hashlib
import inspect
import site
import sys
from functools import lru_cache
from pathlib import Path

from farhand.common.errors import InputError
from farhand.trials.leaderboard.methods.method import METHODS, Method, method_named


@lru_cache(maxsize=64)
def code_of(name: str) -> str:
    """A digest of the code that a method from outside is made of, as this process read it first; so rows of another
    version are not taken for its own. Empty for those built in, whose code the campaign's own digest holds.

    It is that of every Python file beside the method's and beside those of its kinds, or of their packages.
    """
    if ":" not in name and not METHODS.is_outside(name):
        return ""
    digest = hashlib.sha256()
    for path in sorted({path for folder in _places(method_named(name)) for path in folder}):
        digest.update(str(path.name).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:8]


def check_code(name: str, key: str) -> None:
    """Raise InputError where this process has another version of a method than the one that a row is keyed by."""
    code = code_of(name)
    if code and f"/{name}@{code}/" not in key:
        raise InputError(f"the code of {name} has changed since the table was begun; run the command again")


def _places(method: Method) -> list[list[Path]]:
    """The files of each class that the method is made of."""
    classes = [base for kind in (type(method), *method.kinds()) for base in inspect.getmro(kind)]
    modules = {kind.__module__ for kind in classes if kind.__module__.split(".")[0] not in _THEIRS}
    return [_files(module) for module in sorted(modules)]


def _files(module: str) -> list[Path]:
    found = getattr(sys.modules.get(module), "__file__", None)
    if found is None:
        return []
    path = Path(found)
    package = sys.modules.get(module.split(".")[0])
    if "." in module and package is not None and getattr(package, "__file__", None):
        return sorted(Path(str(package.__file__)).parent.rglob("*.py"))
    if str(path.parent) in site.getsitepackages():
        return [path]
    return sorted(path.parent.glob("*.py"))


_THEIRS = {"farhand", "builtins", "abc", "typing", "msgspec"}
"""Top packages whose classes are no part of a method."""
