"""A fresh environment in which Farhand is installed from its wheel, as a user has it."""

import os
import shutil
import subprocess
import sys
import sysconfig
import venv
from collections.abc import Sequence
from pathlib import Path
from unittest.mock import patch

from numba.core.caching import UserProvidedCacheLocator

from farhand.common.compiled import Compiler

ROOT = Path(__file__).resolve().parent.parent
LEFT_OUT = shutil.ignore_patterns(
    ".venv", ".git", "node_modules", "build", "*.egg-info", "__pycache__", "/runs", ".*_cache", ".hypothesis"
)
KERNELS = (
    "robot_side/kernel",
    "operator_side/control/newton_kernel.py",
    "operator_side/control/checks/body_kernel.py",
)


class Environment:
    """A virtual environment that holds nothing but Farhand and what is installed on top.

    The libraries that Farhand needs are those of the environment that runs the tests: installing them again would
    take minutes and gigabytes, and show nothing of Farhand.

    Args:
        folder: to be made.
    """

    def __init__(self, folder: Path) -> None:
        venv.create(folder / "env", with_pip=False, symlinks=True)
        self.python = folder / "env" / "bin" / "python"
        version = f"python{sys.version_info.major}.{sys.version_info.minor}"
        self.packages = folder / "env" / "lib" / version / "site-packages"
        (self.packages / "libraries.pth").write_text(sysconfig.get_paths()["purelib"] + "\n")
        self.empty = folder / "empty"
        self.empty.mkdir()
        self._kept = {"NUMBA_CACHE_DIR": str(folder / "compiled")}
        source = folder / "source"
        shutil.copytree(ROOT, source, symlinks=True, ignore=LEFT_OUT)
        (self.wheel,) = self.install([source], folder / "wheels")
        self._take_compiled()

    def install(self, sources: Sequence[Path], wheels: Path) -> list[Path]:
        """Build the wheels of packages' folders into a new folder, and install them; returns the wheels."""
        self._pip(
            "wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", str(wheels), *map(str, sources)
        )
        made = sorted(wheels.glob("*.whl"))
        # pip counts what the libraries' environment holds as installed here: so it is told where to put it.
        self._pip("install", "--no-deps", "--no-index", "--target", str(self.packages), *map(str, made))
        return made

    def _take_compiled(self) -> None:
        """Take over what the checkout has compiled, as far as it has: the same code, and a minute to compile."""
        for kernel in KERNELS:
            source, installed = ROOT / "farhand" / kernel, self.packages / "farhand" / kernel
            compiled = Compiler(source).folder
            with patch.dict(os.environ, self._kept):
                place = Compiler(installed).folder
            assert place is not None
            file = installed / "__init__.py" if installed.is_dir() else installed
            place /= UserProvidedCacheLocator.get_suitable_cache_subpath(str(file))
            for folder in compiled.iterdir() if compiled else ():
                shutil.copytree(folder, place, dirs_exist_ok=True)

    def _pip(self, *arguments: str) -> None:
        done = subprocess.run(
            [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check", *arguments],
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr

    def run(self, *arguments: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
        """Run `python ARGUMENTS` there, in an empty folder unless another is given."""
        clean = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "PYTEST", "COV"))}
        return subprocess.run(
            [str(self.python), *arguments],
            cwd=cwd or self.empty,
            env=clean | self._kept,
            capture_output=True,
            text=True,
            check=False,
            timeout=300,
        )

    def farhand(self, *arguments: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
        """Run `farhand ARGUMENTS` there."""
        return self.run("-m", "farhand", *arguments, cwd=cwd)
