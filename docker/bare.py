"""Copy into an empty root what an image needs of its base: `bare.py ROOT [--python ENVIRONMENT] PROGRAM...`.

Programs, the libraries that they are linked against and, with --python, the interpreter, its standard library
and the libraries that ENVIRONMENT's packages expect of the system. No package manager, no second shell.
"""

import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Iterable
from pathlib import Path

SYSTEM_FILES = (
    *("/etc/ld.so.cache", "/etc/passwd", "/etc/group", "/etc/nsswitch.conf", "/etc/os-release"),
    "/etc/ssl/certs/ca-certificates.crt",
)
NOT_OF_THE_LIBRARY = shutil.ignore_patterns(
    *("test", "tests", "idlelib", "lib2to3", "tkinter", "turtledemo", "turtle.py", "pydoc_data"),
    *("ensurepip", "distutils", "site-packages", "dist-packages", "config-3*", "__pycache__"),
    *("_sqlite3.*", "_curses*", "readline.*", "_*dbm.*", "_tkinter.*", "_*test*.so"),
)
"""What no program of Farhand imports from Python's standard library."""


def bring(path: Path, root: Path) -> None:
    """Copy a file to the same place below root; of a link, the link and what it leads to."""
    place = path.parent.resolve() / path.name
    target = root / place.relative_to("/")
    if target.is_symlink() or target.exists():
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy2(place, target, follow_symlinks=False)
    if place.is_symlink():
        bring(place.parent / place.readlink(), root)


def libraries(files: Iterable[Path], environment: Path | None) -> set[Path]:
    """The system's libraries that files are linked against, and the loader."""
    found: set[Path] = set()
    for file in files:
        done = subprocess.run(["ldd", str(file)], capture_output=True, text=True, check=False)
        for line in done.stdout.splitlines():
            words = line.replace("=>", " ").split()
            found |= {Path(word) for word in words if word.startswith("/") and not word.endswith(":")}
    return {path for path in found if environment is None or environment not in path.parents}


def main(root: Path, environment: Path | None, programs: list[str]) -> None:
    """Fill a root."""
    for name in ("bin", "sbin", "lib", "lib64"):  # where /usr is merged, they are links into it
        if Path("/", name).is_symlink():
            root.mkdir(exist_ok=True)
            (root / name).symlink_to(Path("/", name).readlink())
    wanted = []
    for name in programs:
        place = shutil.which(name)
        if place is None:
            sys.exit(f"bare.py: the base has no program {name!r}")
        wanted.append(Path(place))
    linked = list(wanted)
    if environment is not None:
        standard = Path(sysconfig.get_path("stdlib"))
        shutil.copytree(standard, root / standard.relative_to("/"), ignore=NOT_OF_THE_LIBRARY)
        wanted += [environment / "bin/python"]
        wanted += [path for path in map(Path, SYSTEM_FILES) if path.exists()]
        linked += [Path(sys.executable), *root.rglob("*.so"), *environment.rglob("*.so*")]
    for path in [*wanted, *libraries(linked, environment)]:
        bring(path, root)


if __name__ == "__main__":
    arguments = sys.argv[2:]
    with_python = arguments[:1] == ["--python"]
    venv = Path(arguments[1]) if with_python else None
    main(Path(sys.argv[1]), venv, arguments[2:] if with_python else arguments)
