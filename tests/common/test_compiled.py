"""Compiled code outlives a process, and never a change of any file of its kernel."""

import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

from farhand.common.compiled import NOTICE, Compiler
from tests.examples import also

INNER = "from tests_kernel.jit import compiled\n@compiled\ndef inner(x):\n    return x + {add}\n"
OUTER = (
    "from tests_kernel.jit import compiled\nfrom tests_kernel.inner import inner\n"
    "@compiled\ndef outer(x):\n    return 2.0 * inner(x)\n"
)
JIT = (
    "from pathlib import Path\nfrom farhand.common.compiled import Compiler\n"
    "compiled = Compiler(Path(__file__).parent)\n"
)
ASK = (
    "from tests_kernel.outer import outer\nfrom tests_kernel.jit import compiled\n"
    "print(outer(1.0), len(outer.stats.cache_hits), compiled.folder, compiled.notice)"
)


def write(folder, add):
    kernel = folder / "tests_kernel"
    kernel.mkdir(exist_ok=True)
    for name, text in {"__init__": "", "jit": JIT, "inner": INNER.format(add=add), "outer": OUTER}.items():
        (kernel / f"{name}.py").write_text(text, encoding="utf-8")
    return kernel


def ask(folder, **environment):
    """What the kernel computes, how often that came from the cache, and where that is."""
    path = os.pathsep.join([str(folder), *sys.path])
    answer = subprocess.run(
        [sys.executable, "-c", ASK],
        env={**os.environ, "PYTHONPATH": path, **environment},
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    ).stdout.split(maxsplit=3)
    return float(answer[0]), int(answer[1]), answer[2]


@pytest.mark.long
def test_a_change_in_another_file_of_the_kernel_is_seen(tmp_path):
    kernel = write(tmp_path, 1.0)
    first = ask(tmp_path)
    assert first[:2] == (4.0, 0)
    assert ask(tmp_path) == (4.0, 1, first[2])
    write(tmp_path, 2.0)
    second = ask(tmp_path)
    assert second[:2] == (6.0, 0)
    assert second[2] != first[2]
    kept = [folder.name for folder in (kernel / "__pycache__").glob("tests_kernel-*")]
    assert kept == [Path(second[2]).name]  # what was stale is gone


@pytest.fixture
def source(tmp_path, monkeypatch):
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "tmp"))
    (tmp_path / "tmp").mkdir()
    (tmp_path / "kernel").mkdir()
    file = tmp_path / "kernel" / "one.py"
    file.write_text("", encoding="utf-8")
    return file


def test_the_places_are_tried_in_turn(source, tmp_path, monkeypatch):
    assert Compiler(source).folder.parent == source.parent / "__pycache__"
    (source.parent / "__pycache__").rename(tmp_path / "away")
    (source.parent / "__pycache__").write_text("no folder can be made here", encoding="utf-8")
    assert Compiler(source).folder.parent == tmp_path / "cache" / "farhand"
    (tmp_path / "cache" / "farhand").chmod(0o777)  # others could put code there
    assert Compiler(source).folder.parent == tmp_path / "tmp" / f"farhand-{os.getuid()}"
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "given"))
    assert Compiler(source).folder.parent == tmp_path / "given"


def test_without_a_place_it_says_so_and_compiles_all_the_same(source, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("", encoding="utf-8")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file"))
    compiler = Compiler(source)
    assert compiler.folder is None
    assert compiler.notice == NOTICE
    assert "\n" not in NOTICE
    assert compiler(lambda x: x + 1.0)(2.0) == 3.0


def test_two_installs_do_not_remove_each_others_code(source, tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "shared"))
    (tmp_path / "other" / "kernel").mkdir(parents=True)
    other = tmp_path / "other" / "kernel" / "one.py"
    other.write_text("x = 1", encoding="utf-8")
    first, second = Compiler(source).folder, Compiler(other).folder
    assert first.is_dir()
    assert second.is_dir()
    source.write_text("x = 2", encoding="utf-8")
    assert Compiler(source).folder.is_dir()
    assert not first.exists()
    assert second.is_dir()


@pytest.mark.parametrize("size", [0, also(1)])
def test_a_disk_without_space_costs_the_cache_alone(tmp_path, size):
    """As far as a program sees it: no file may be larger, in KiB; compiled code is."""
    write(tmp_path, 1.0)
    path = os.pathsep.join([str(tmp_path), *sys.path])
    cramped = ["bash", "-c", f"ulimit -f {size}; exec {sys.executable} -c '{ASK}'"]
    environment = {**os.environ, "PYTHONPATH": path}
    done = subprocess.run(cramped, env=environment, capture_output=True, text=True, check=True, timeout=120)
    assert done.stdout.split()[:2] == ["4.0", "0"]
    assert ask(tmp_path)[:2] == (4.0, 0)
    assert ask(tmp_path)[:2] == (4.0, 1)


def test_a_function_is_compiled_once_for_numbers_and_literals(tmp_path, monkeypatch):
    kernel = write(tmp_path, 1.0)
    (kernel / "both.py").write_text(
        "from tests_kernel.jit import compiled\nfrom tests_kernel.inner import inner\n"
        "@compiled\ndef both(n):\n    return inner(0) + inner(n)\n",
        encoding="utf-8",
    )
    monkeypatch.syspath_prepend(tmp_path)
    both, inner = import_module("tests_kernel.both").both, import_module("tests_kernel.inner").inner
    assert both(3) == 5.0
    assert len(inner.signatures) == 1
