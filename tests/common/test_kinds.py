"""Registries: built-in kinds, kinds that packages bring, and what is said of those that cannot be."""

import importlib.metadata

import pytest

from farhand.common.errors import InputError
from farhand.common.kinds import Kinds, made


class Base:
    """What the kinds are."""


class Mine(Base):
    """A kind from outside."""


class Other:
    """No kind."""


class _Distribution:
    name = "their-package"


def point(name: str, value: str) -> importlib.metadata.EntryPoint:
    made = importlib.metadata.EntryPoint(name, value, "farhand.things")
    vars(made).update(dist=_Distribution())
    return made


@pytest.fixture
def outside(monkeypatch):
    """A function that says what installed packages bring."""
    brought: list[importlib.metadata.EntryPoint] = []
    monkeypatch.setattr(
        "importlib.metadata.entry_points", lambda group: [p for p in brought if p.group == group]
    )
    return brought.append


def kinds() -> Kinds[type[Base]]:
    return Kinds(
        "thing", "farhand.things", Base, {"base": f"{__name__}:Base", "heavy": "no_such_module:Heavy"}
    )


def test_a_built_in_kind_is_imported_only_when_asked_for(outside):
    found = kinds()
    assert found.names() == ("base", "heavy")
    assert found.get("base").__name__ == "Base"
    with pytest.raises(ModuleNotFoundError):
        found.get("heavy")


def test_a_package_brings_a_kind(outside):
    outside(point("mine", f"{__name__}:Mine"))
    found = kinds()
    assert found.names() == ("base", "heavy", "mine")
    assert "mine" in found
    assert found.get("mine").__name__ == "Mine"


@pytest.mark.parametrize(
    ("points", "name", "words"),
    [
        ((), "bose", "margin.kind 'bose': no such thing; is 'base' meant? there are base, heavy"),
        ((), "zzz", "margin.kind 'zzz': no such thing; there are base, heavy"),
        (
            (("mine", "no_such_module:Mine"),),
            "mine",
            "package their-package: farhand.things: thing 'mine' cannot",
        ),
        ((("mine", f"{__name__}:Other"),), "mine", "is no subclass of"),
        ((("mine", f"{__name__}:Mine"), ("mine", "b:C")), "mine", "each brings a thing 'mine'"),
        ((("base", f"{__name__}:Mine"),), "base", "'base' is built in"),
        (
            (("my thing", f"{__name__}:Mine"),),
            "my thing",
            "'my thing' cannot be used: a name is 1 to 64 letters",
        ),
        (
            (("my thing", f"{__name__}:Mine"),),
            "my",
            "package their-package: farhand.things: 'my thing' cannot",
        ),
    ],
)
def test_what_cannot_be_is_one_line(outside, points, name, words):
    for entry in points:
        outside(point(*entry))
    with pytest.raises(InputError) as caught:
        kinds().get(name, "margin.kind")
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_module_that_exits_at_import_is_told_of(outside, tmp_path, monkeypatch):
    (tmp_path / "leaves_at_once.py").write_text("import sys\nsys.exit(3)\n")
    monkeypatch.syspath_prepend(tmp_path)
    outside(point("mine", "leaves_at_once:Mine"))
    with pytest.raises(InputError, match="SystemExit: 3"):
        kinds().get("mine")


def test_what_a_kind_raises_when_it_is_made_is_one_line_that_says_where():
    def broken():
        raise RuntimeError("no\nlicence")

    with pytest.raises(InputError) as caught:
        made("margin law 'mine'", broken)
    assert str(caught.value).startswith(
        "margin law 'mine' cannot be used: RuntimeError: no licence (test_kinds.py, line "
    )
    with pytest.raises(InputError, match="asked for"):
        made("it", lambda: (_ for _ in ()).throw(InputError("asked for")))
    assert made("it", lambda: 3) == 3


@pytest.mark.parametrize("name", ["my thing", "", "a:b", "a[b]", "a\nb", "-a", "a" * 65])
def test_a_name_that_nobody_can_write_is_no_kind_and_disturbs_no_other(outside, name):
    outside(point(name, f"{__name__}:Mine"))
    outside(point("mine", f"{__name__}:Mine"))
    found = kinds()
    assert found.names() == ("base", "heavy", "mine")
    assert found.get("mine").__name__ == "Mine"
    assert name not in found


def test_a_script_adds_a_kind_of_its_own(outside):
    outside(point("theirs", f"{__name__}:Mine"))
    found = kinds()
    found.add("own", Mine)
    assert "own" in found
    assert found.get("own") is Mine
    assert found.names() == ("base", "heavy", "own", "theirs")
    assert found.is_outside("own")
    found.add("own", Base)  # a notebook's cell that runs again
    assert found.get("own") is Base
    for name, kind, line in [
        ("base", Mine, "there already"),
        ("theirs", Mine, "there already"),
        ("no name", Mine, "1 to 64 letters"),
        ("other", Other, "no subclass of Base"),
        ("made", Mine(), "no subclass of Base"),
    ]:
        with pytest.raises(InputError, match=f"thing '{name}'.*{line}"):
            found.add(name, kind)
