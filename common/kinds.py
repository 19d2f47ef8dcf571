"""The one form of every registry: kinds by name, those built in and those that installed packages bring.

A kind is a class in a small file of its own. Built-in kinds are named as `module:Class` and imported only when they
are asked for, so that a program starts fast and needs only what it uses. Packages from outside bring theirs by
entry points (`[project.entry-points."farhand.margins"]`, `mine = "my_package.my_module:MyMargin"`). A script adds its
own with `add`, for its own process.
"""

import difflib
import importlib
import importlib.metadata
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Generic, TypeVar

from farhand.common.errors import FarhandError, InputError, in_one_line

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,63}\Z")

T = TypeVar("T")
R = TypeVar("R")


def made(what: str, make: Callable[[], R]) -> R:
    """What `make` makes; whatever somebody's kind raises in it is an InputError of one line.

    Args:
        what: is made, for the message, e.g. "margin law 'mine'".
        make: makes it.
    """
    try:
        return make()
    except FarhandError:
        raise
    except Exception as error:
        raise InputError(f"{what} cannot be used: {in_one_line(error)}") from None


class Kinds(Generic[T]):
    """A registry.

    Args:
        what: what the kinds are, for messages, e.g. "margin law".
        group: name of the entry points, e.g. "farhand.margins".
        base: what each kind must be a subclass of, as a class or as `module:Class`.
        built_in: name -> `module:attribute`, in the order in which they are listed.
    """

    def __init__(self, what: str, group: str, base: type | str, built_in: Mapping[str, str]) -> None:
        self.what, self.group = what, group
        self._base = base
        self._built_in = dict(built_in)
        self._outside: dict[str, list[importlib.metadata.EntryPoint]] | None = None
        self._ill_named: dict[str, list[importlib.metadata.EntryPoint]] = {}
        self._loaded: dict[str, T] = {}
        self._added: set[str] = set()

    def names(self) -> tuple[str, ...]:
        """All names: the built-in ones first, then those from outside in alphabetical order."""
        return (*self._built_in, *sorted((set(self._entry_points()) | self._added) - set(self._built_in)))

    def add(self, name: str, kind: T) -> None:
        """Take in a kind of this process's own: whatever runs in it finds the kind by name.

        Other processes, such as the workers of a campaign, do not: there, a package brings it. The same name
        again takes the new kind, as happens where a notebook's cell runs twice.

        Raises:
            InputError: the name cannot be written or belongs to another, or this is no such kind.
        """
        if not _NAME.match(name):
            raise InputError(
                f"{self.what} {name!r}: a name is 1 to 64 letters, digits, dots, dashes or underscores"
            )
        if name in self._built_in or name in self._entry_points():
            raise InputError(f"{self.what} {name!r} is there already; choose another name")
        base = self._base_class()
        if not (isinstance(kind, type) and issubclass(kind, base)):
            raise InputError(f"{self.what} {name!r}: {kind!r} is no subclass of {base.__qualname__}")
        self._loaded[name] = kind
        self._added.add(name)

    @contextmanager
    def lent(self, name: str, kind: T) -> Iterator[None]:
        """A kind is there by name for so long; what `add` took in by that name before is there again afterwards.

        Raises:
            InputError: see `add`.
        """
        if name in self and self._loaded.get(name) is kind:
            yield
            return
        before = self._loaded.get(name) if name in self._added else None
        self.add(name, kind)
        try:
            yield
        finally:
            if before is not None:
                self._loaded[name] = before
            else:
                self._added.discard(name)
                self._loaded.pop(name, None)

    def is_outside(self, name: str) -> bool:
        """Whether an installed package brings it, or nobody does."""
        return name not in self._built_in

    def ill_named(self) -> str:
        """What to say of kinds whose names nobody can write in a scenario or SPEC; empty without any."""
        self._entry_points()
        names = ", ".join(map(repr, sorted(self._ill_named)))
        if not names:
            return ""
        points = [point for each in self._ill_named.values() for point in each]
        return (
            f"; {_brought(points)}: {self.group}: {names} cannot be used: a name is 1 to 64 letters, digits, dots, "
            "dashes or underscores, without blanks"
        )

    def __contains__(self, name: object) -> bool:
        return name in self._built_in or name in self._added or name in self._entry_points()

    def get(self, name: str, where: str = "", beside: tuple[str, ...] = ()) -> T:
        """The kind of that name.

        Args:
            name: which.
            where: what asks, for the message, e.g. "margin.kind" or "--margin".
            beside: what else that place takes, for the message.

        Raises:
            InputError: no such kind; or an installed package's cannot be imported, is none, or its name is taken or
                none that can be written.
        """
        if name not in self._loaded:
            self._loaded[name] = self._load(name, where, beside)
        return self._loaded[name]

    def _load(self, name: str, where: str, beside: tuple[str, ...]) -> T:
        points = self._entry_points().get(name, [])
        if name in self._built_in:
            if points:
                raise InputError(
                    f"{_brought(points)}: {self.group}: {name!r} is built in; choose another name"
                )
            built_in: T = _import(self._built_in[name])
            return built_in
        if not points:
            raise InputError(self._unknown(name, where, beside) + self.ill_named())
        if len(points) > 1:
            raise InputError(
                f"{_brought(points)}: {self.group}: each brings a {self.what} {name!r}; remove one"
            )
        try:
            kind: T = points[0].load()
        except (Exception, SystemExit) as error:  # whatever a stranger's module does at import
            raise InputError(
                f"{_brought(points)}: {self.group}: {self.what} {name!r} cannot be imported from "
                f"{points[0].value}: {type(error).__name__}: {error}"
            ) from None
        base = self._base_class()
        if not (isinstance(kind, type) and issubclass(kind, base)):
            raise InputError(
                f"{_brought(points)}: {self.group}: {name!r} is {points[0].value}, which is no subclass of "
                f"{base.__module__}.{base.__qualname__}"
            )
        return kind

    def _base_class(self) -> Any:
        return _import(self._base) if isinstance(self._base, str) else self._base

    def _entry_points(self) -> dict[str, list[importlib.metadata.EntryPoint]]:
        if self._outside is None:
            self._outside = {}
            for point in importlib.metadata.entry_points(group=self.group):
                into = self._outside if _NAME.match(point.name) else self._ill_named
                into.setdefault(point.name, []).append(point)
        return self._outside

    def _unknown(self, name: str, where: str, beside: tuple[str, ...]) -> str:
        there = (*self.names(), *beside)
        close = difflib.get_close_matches(name, there, n=1)
        hint = f"is {close[0]!r} meant? " if close else ""
        place = f"{where} {name!r}" if where else repr(name)
        return f"{place}: no such {self.what}; {hint}there are {', '.join(there)}"


def _import(path: str) -> Any:
    """What `module:attribute` names."""
    module, _, attribute = path.partition(":")
    return getattr(importlib.import_module(module), attribute)


def _brought(points: list[importlib.metadata.EntryPoint]) -> str:
    names = sorted({point.dist.name if point.dist is not None else "?" for point in points})
    return f"package {' and '.join(names)}"
