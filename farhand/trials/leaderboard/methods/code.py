"""Which version of a method from outside made a row."""

import ast
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

    It is that of the files of its classes and of what they import from beside them, or of their packages whole.
    """
    if ":" not in name and not METHODS.is_outside(name):
        return ""
    digest = hashlib.sha256()
    for path in sorted(_files_of(method_named(name))):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:8]


def check_code(name: str, key: str) -> None:
    """Raise InputError where this process has another version of a method than the one that a row is keyed by."""
    code = code_of(name)
    if code and f"/{name}@{code}/" not in key:
        raise InputError(f"the code of {name} has changed since the table was begun; run the command again")


def _files_of(method: Method) -> set[Path]:
    found: set[Path] = set()
    for kind in (type(method), *method.kinds()):
        for base in inspect.getmro(kind):
            top = base.__module__.partition(".")[0]
            modules = (sys.modules.get(top), sys.modules.get(base.__module__))
            file = next(filter(None, (getattr(module, "__file__", None) for module in modules)), None)
            if top != "farhand" and top not in sys.stdlib_module_names and file is not None:
                _follow(Path(file), found)
    return found


def _follow(path: Path, found: set[Path]) -> None:
    """Take in a module, and what lies beside it that it imports; of a package, all its files."""
    if path in found:
        return
    if path.name == "__init__.py":
        found.update(each for each in path.parent.rglob("*") if each.is_file() and each.suffix != ".pyc")
        return
    found.add(path)
    if path.suffix != ".py" or str(path.parent) in (*site.getsitepackages(), site.getusersitepackages()):
        return  # what else is installed is no part of it
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        names = [each.name for each in node.names] if isinstance(node, ast.Import) else []
        names += [node.module] if isinstance(node, ast.ImportFrom) and node.module else []
        for top in {name.partition(".")[0] for name in names}:
            for beside in (path.parent / f"{top}.py", path.parent / top / "__init__.py"):
                if beside.is_file():
                    _follow(beside, found)
