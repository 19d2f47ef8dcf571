"""Compiled functions, kept between runs: a kernel may be several files, and no stale code is ever loaded.

numba's own cache watches only the file in which a function stands, not those from which it calls others. So a kernel's
code is kept in a folder that is named after a hash of all its files: beside the source, else in the user's cache, else
in the temporary directory. Folders of the kernel's earlier versions are removed.
"""

import hashlib
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

NOTICE = "no writable place for compiled code (set NUMBA_CACHE_DIR): it is compiled anew at each start"
_DIGITS = 16
_WATCHERS: list[Callable[[], None]] = []


class Compiler:
    """The decorator of a kernel's functions; they are compiled when they are first called.

    A kernel must take every constant from its own files: what it imports from elsewhere is compiled in, and its changes
    go unseen.

    Args:
        sources: the kernel's files; a folder stands for every Python file right in it.

    Attributes:
        folder: where the code is kept; None where nothing can be written.
        notice: one line that says so then, else empty.
    """

    def __init__(self, *sources: Path) -> None:
        files = [file.resolve() for source in sources for file in _files(source)]
        place = _digest([str(file).encode() for file in files])
        text = _digest([file.read_bytes() for file in files])
        kernel = f"{files[0].parent.name}-{place[:8]}-"
        self.folder = _choose(files[0].parent / "__pycache__", kernel + text[:_DIGITS])
        self.notice = "" if self.folder else NOTICE
        if self.folder is not None:
            _remove_others(self.folder, kernel)

    def __call__(self, function: Callable[..., Any]) -> Any:
        """The compiled function. Raises ImportError where numba is missing."""
        import numba.core.config

        settings = vars(numba.core.config)
        before = settings["CACHE_DIR"]
        settings["CACHE_DIR"] = str(self.folder or before)  # numba reads it now, and not when it compiles
        try:
            compiled = numba.njit(
                cache=self.folder is not None, nogil=True, fastmath=False, error_model="numpy"
            )(function)
        finally:
            settings["CACHE_DIR"] = before
        _spare_a_full_disk(compiled)
        _tell_of_compiling(compiled)
        _take_literals_as_numbers(compiled)
        return compiled

    def where_possible(self, function: Callable[..., Any]) -> Any:
        """The same, but the plain function where numba is missing."""
        try:
            return self(function)
        except ImportError:
            return function


@contextmanager
def when_compiling(begins: Callable[[], None]) -> Iterator[None]:
    """Have `begins` called before each function that is compiled within, by any thread; not for what is loaded."""
    _WATCHERS.append(begins)
    try:
        yield
    finally:
        _WATCHERS.remove(begins)


def _tell_of_compiling(compiled: Any) -> None:
    """What is not found in the cache is compiled."""
    cache = compiled._cache
    load = cache.load_overload

    def load_or_tell(signature: Any, context: Any) -> Any:
        code = load(signature, context)
        if code is None:
            for begins in tuple(_WATCHERS):
                begins()
        return code

    cache.load_overload = load_or_tell


def _spare_a_full_disk(compiled: Any) -> None:
    """Use what is compiled though there is no space to keep it: it is compiled again at the next start."""
    cache = compiled._cache
    save = cache.save_overload

    def save_if_possible(signature: Any, code: Any) -> None:
        with suppress(OSError):
            save(signature, code)

    cache.save_overload = save_if_possible


def _take_literals_as_numbers(compiled: Any) -> None:
    """Compile a function once for `f(0)` and `f(n)`: to numba a literal is a type of its own."""
    from numba.core.types import unliteral

    template_for = compiled.get_call_template

    def template_for_numbers(args: tuple[Any, ...], kws: dict[str, Any]) -> Any:
        numbers = dict(zip(kws, map(unliteral, kws.values()), strict=True))
        return template_for(tuple(map(unliteral, args)), numbers)

    compiled.get_call_template = template_for_numbers


def _files(source: Path) -> list[Path]:
    return sorted(source.glob("*.py")) if source.is_dir() else [source]


def _digest(parts: list[bytes]) -> str:
    total = hashlib.sha256()
    for part in parts:
        total.update(hashlib.sha256(part).digest())
    return total.hexdigest()


def _choose(beside: Path, name: str) -> Path | None:
    """The first of the places where the folder can be made."""
    given = os.environ.get("NUMBA_CACHE_DIR")
    if given:
        return _made(Path(given), name, private=False)
    home = Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"))
    own = [home / "farhand"]
    with suppress(OSError):  # every disk is full
        own.append(Path(tempfile.gettempdir()) / f"farhand-{os.getuid()}")
    return _made(beside, name, private=False) or next(
        (
            folder
            for root in own
            if root.is_absolute() and (folder := _made(root, name, private=True)) is not None
        ),
        None,
    )


def _made(root: Path, name: str, private: bool) -> Path | None:
    """`root`/`name`, made and writable, or None; where private, nobody else may own or write `root`."""
    try:
        root.mkdir(parents=True, exist_ok=True, mode=0o700 if private else 0o777)
        if private:  # compiled code is loaded from here: nobody else may have put it there
            facts = root.lstat()
            if facts.st_uid != os.getuid() or facts.st_mode & 0o022:
                return None
        folder = root / name
        folder.mkdir(exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except OSError:
        return None


def _remove_others(folder: Path, kernel: str) -> None:
    """Remove what earlier versions of the kernel left beside `folder`."""
    for other in folder.parent.glob(kernel + "?" * _DIGITS):
        if other != folder:
            shutil.rmtree(other, ignore_errors=True)
