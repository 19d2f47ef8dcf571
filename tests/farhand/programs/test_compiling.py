"""What is compiled, and takes long, is announced; what is only loaded is not, however long that takes."""

import importlib.util
import sys
import threading
from pathlib import Path

import pytest

from farhand.common.compiled import Compiler
from farhand.programs.compiling import LINE, prepare_aloud

pytest.importorskip("numba")


class Preparing:
    """Compiles a function, or loads it, and waits until it is told on."""

    def __init__(self, folder: Path, told: threading.Event | None) -> None:
        self.folder, self.told = folder, told

    def prepare(self):
        kernel = self.folder / "kernel.py"
        kernel.write_text("def double(x):\n    return 2.0 * x\n")
        # A module as any other: what is compiled is kept by its name.
        spec = importlib.util.spec_from_file_location("compiled_for_a_test", kernel)
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        sys.modules[spec.name] = module
        try:
            spec.loader.exec_module(module)
            assert Compiler(kernel)(module.double)(1.5) == 3.0
        finally:
            del sys.modules[spec.name]
        assert self.told is None or self.told.wait(10.0)


def test_only_what_is_compiled_is_said(tmp_path, monkeypatch):
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    said, told = [], threading.Event()

    def tell(line):
        said.append(line)
        told.set()

    prepare_aloud(Preparing(tmp_path, told), tell, 0.0)
    assert said == [LINE]
    slow = threading.Event()
    threading.Timer(0.3, slow.set).start()
    prepare_aloud(Preparing(tmp_path, slow), tell, 0.0)
    assert said == [LINE]  # found in the cache
    prepare_aloud(Preparing(tmp_path / "..", None), tell, 60.0)
    assert said == [LINE]
