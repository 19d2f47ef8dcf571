"""A fresh environment in which Farhand is installed from its wheel, as a user has it."""

import os
import shutil
import subprocess
import sys
import sysconfig
import venv
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LEFT_OUT = shutil.ignore_patterns(
    ".venv", ".git", "node_modules", "build", "*.egg-info", "__pycache__", "/runs", ".*_cache", ".hypothesis"
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
        source = folder / "source"
        shutil.copytree(ROOT, source, symlinks=True, ignore=LEFT_OUT)
        (self.wheel,) = self.install([source], folder / "wheels")

    def install(self, sources: Sequence[Path], wheels: Path) -> list[Path]:
        """Build the wheels of packages' folders into a new folder, and install them; returns the wheels."""
        self._pip(
            "wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", str(wheels), *map(str, sources)
        )
        made = sorted(wheels.glob("*.whl"))
        # pip counts what the libraries' environment holds as installed here: so it is told where to put it.
        self._pip("install", "--no-deps", "--no-index", "--target", str(self.packages), *map(str, made))
        return made

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
            env=clean | {"NUMBA_CACHE_DIR": str(self.empty.parent / "compiled")},
            capture_output=True,
            text=True,
            check=False,
            timeout=300,
        )

    def farhand(self, *arguments: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
        """Run `farhand ARGUMENTS` there."""
        return self.run("-m", "farhand", *arguments, cwd=cwd)
