import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
DOCKER = ROOT / "docker"


def load(name: str):
    spec = importlib.util.spec_from_file_location(f"docker_{name}", DOCKER / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


slim = load("slim")


def test_equal_libraries_become_links(tmp_path):
    for name in ("liba.so", "liba.so.3", "liba.so.3.7"):
        (tmp_path / name).write_bytes(b"same")
    (tmp_path / "libb.so").write_bytes(b"other")
    slim.link_copies(tmp_path)
    assert (tmp_path / "liba.so").readlink() == Path("liba.so.3.7")
    assert (tmp_path / "liba.so").read_bytes() == b"same"
    assert not (tmp_path / "libb.so").is_symlink()
    assert slim.weight([tmp_path]) == 9


def test_only_asked_for_solvers_stay(tmp_path, monkeypatch):
    asks = {
        "_casadi.so": ["libcasadi.so.3"],
        "libcasadi.so.3": [],
        "libcasadi_nlpsol_ipopt.so": ["libipopt.so"],
        "libipopt.so": ["libmumps.so", "libc.so.6"],
        "libmumps.so": [],
        "libcasadi_conic_highs.so": ["libhighs.so"],
        "libhighs.so": [],
    }
    for name in asks:
        (tmp_path / name).write_bytes(name.encode())
    monkeypatch.setattr(slim, "needed", lambda path: asks[path.name])
    gone = {path.name for path in slim.unwanted_solvers(tmp_path)}
    assert gone == {"libcasadi_conic_highs.so", "libhighs.so"}


def test_libraries_that_somebody_asks_for_stay(tmp_path, monkeypatch):
    asks = {"module.so": ["liba.so.1"], "liba.so.1.2": ["libb.so"], "libb.so": [], "libc.so": ["libb.so"]}
    for name in asks:
        (tmp_path / name).touch()
    (tmp_path / "liba.so.1").symlink_to("liba.so.1.2")
    monkeypatch.setattr(slim, "needed", lambda path: asks[path.name])
    libraries = list(tmp_path.glob("lib*"))
    assert [path.name for path in slim.unneeded(libraries, [tmp_path / "module.so"])] == ["libc.so"]


def test_without_sources_a_package_still_works(tmp_path):
    package = tmp_path / "package"
    package.mkdir()
    (package / "__init__.py").write_text("from package.inner import ANSWER")
    (package / "inner.py").write_text("ANSWER = 42")
    (package / "template.py").write_text("not {{ python }} at all")
    load("sourceless").main(tmp_path)
    assert sorted(path.name for path in package.iterdir()) == ["__init__.pyc", "inner.pyc", "template.py"]
    command = [sys.executable, "-c", "import package; print(package.ANSWER)"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout == "42\n"


def test_a_bare_root_has_a_program_and_what_it_is_linked_against(tmp_path):
    root = tmp_path / "root"
    load("bare").main(root, None, ["sh"])
    assert (root / "bin/sh").resolve().is_file()
    names = {path.name for path in root.rglob("*") if path.is_file()}
    assert any(name.startswith("libc.so") for name in names)
    assert any(name.startswith("ld-") for name in names)
    assert len(names) < 12


def test_the_images_requirements_are_the_programs_without_the_laboratory():
    if sys.version_info < (3, 11):
        pytest.skip("the image's Python is 3.11")
    found = load("runtime_requirements").requirements((ROOT / "pyproject.toml").read_text())
    names = {line.split(">")[0].split("=")[0] for line in found}
    assert {"eclipse-zenoh", "pybullet", "casadi", "numba"} <= names
    assert not {"pyarrow", "pytest"} & names
