"""The console's page that is checked in is the one that its source builds, and a change of either is seen."""

import importlib.util
import shutil
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
spec = importlib.util.spec_from_file_location("page_is_built", ROOT / "scripts" / "page_is_built.py")
page_is_built = importlib.util.module_from_spec(spec)
spec.loader.exec_module(page_is_built)


def test_the_page_that_is_checked_in_is_built_from_its_source():
    assert page_is_built.troubles() == []


@pytest.mark.parametrize("name", ["page/src/hand.ts", "page/index.html", "static/page.js", "static/page.css"])
def test_a_change_without_a_build_is_seen(tmp_path, name):
    console = tmp_path / "console"
    ignored = shutil.ignore_patterns("node_modules", "*.py")
    shutil.copytree(page_is_built.CONSOLE, console, ignore=ignored)
    (console / name).write_bytes((console / name).read_bytes() + b" ")
    (line,) = page_is_built.troubles(console)
    assert "make page" in line


def test_a_page_that_is_too_heavy_is_seen(monkeypatch):
    monkeypatch.setattr(page_is_built, "MOST_BYTES", 1000)
    assert "at most 1000" in page_is_built.troubles()[0]
