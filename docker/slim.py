"""Take out of an environment what no program of Farhand opens: `slim.py ENVIRONMENT`; prints what it saved.

Headers, tests, robots and solvers that nobody asked for; debugging symbols; and libraries that lie there
three times, since a wheel cannot hold symbolic links.
"""

import hashlib
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

MEGABYTE = 1e6
GROUPS: dict[str, tuple[str, ...]] = {
    "headers, build files": (
        "cmeel.prefix/include",
        "cmeel.prefix/bin",
        "cmeel.prefix/share/cmake",
        "cmeel.prefix/share/doc",
        "cmeel.prefix/lib/cmake",
        "cmeel.prefix/lib/pkgconfig",
        "casadi/include",
        "casadi/cmake",
        "casadi/pkgconfig",
        "**/*.a",
        "**/*.la",
        "**/*.pyi",
        "**/*.h",
        "**/*.hpp",
        "**/*.pxd",
    ),
    "tests, samples": (
        "scipy/**/tests",
        "matplotlib/tests",
        "matplotlib/mpl-data/sample_data",
        "mpl_toolkits/*/tests",
        "numba/tests",
        "numba/cuda/tests",
        "pinocchio/**/tests",
        *(f"numpy/**/tests/{name}" for name in ("test_*.py", "data", "examples", "src")),
    ),
    "parts of packages that no program imports": (
        *(f"scipy/{name}" for name in ("io", "signal", "cluster", "odr", "datasets", "fftpack", "misc")),
        "numpy/distutils",
        "numba/cuda",
        "tzdata",
        "tzdata-*.dist-info",
        *(f"PIL/_{name}.*.so" for name in ("avif", "webp", "imagingft", "imagingcms", "imagingtk")),
        "pygments/lexers/[a-z]*.py",
        "pygments/lexers/_[a-z]*_builtins.py",
    ),
    "PyBullet's games and OpenGL": (
        "pybullet_data",
        "pybullet_envs",
        "pybullet_examples",
        "pybullet_robots",
        "pybullet_utils",
        "eglRenderer*.so",
    ),
    "installers": ("pip", "pip-*.dist-info", "setuptools", "setuptools-*.dist-info", "pkg_resources"),
}
ROBOTS = "cmeel.prefix/share/example-robot-data/robots"
KEPT_ROBOTS = ("ur_description", "panda_description")
"""Of the arms that are known by name."""
KEPT_LEXERS = ("python.py", "special.py")
"""What rich asks Pygments for, to show where a program failed."""
KEPT_PLUGINS = (
    "nlpsol_ipopt",
    "nlpsol_sqpmethod",
    "conic_osqp",
    "conic_qrqp",
    "linsol_",
    "importer_",
    "blas_",
)
"""CasADi's plugins that operator_side names, and those that they load by themselves."""


def unused_descriptions(robots: Path) -> list[Path]:
    """All but the arms that are known by name; of those the meshes that are only drawn."""
    others = [path for path in robots.iterdir() if path.name not in KEPT_ROBOTS]
    for name in KEPT_ROBOTS:
        others += robots.joinpath(name).glob("meshes/**/visual")
    return others


def weight(paths: Iterable[Path]) -> int:
    """Bytes in files and folders; links weigh nothing."""
    total = 0
    for path in paths:
        inside = path.rglob("*") if path.is_dir() and not path.is_symlink() else (path,)
        total += sum(each.stat().st_size for each in inside if each.is_file() and not each.is_symlink())
    return total


def remove(paths: Iterable[Path]) -> None:
    """Remove files and folders; what is gone already is fine."""
    for path in list(paths):
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink(missing_ok=True)


def link_copies(folder: Path) -> None:
    """Of equal libraries of one folder, keep the one with the longest name; the others become links to it."""
    same: dict[tuple[Path, str], list[Path]] = {}
    for path in folder.rglob("*.so*"):
        if path.is_file() and not path.is_symlink():
            content = hashlib.sha256(path.read_bytes()).hexdigest()
            same.setdefault((path.parent, content), []).append(path)
    for copies in same.values():
        kept = max(copies, key=lambda path: (len(path.name), path.name))
        for path in copies:
            if path != kept:
                path.unlink()
                path.symlink_to(kept.name)


def needed(library: Path) -> list[str]:
    """Names of the libraries that one asks the loader for."""
    found = subprocess.run(["readelf", "-d", str(library)], capture_output=True, text=True, check=True).stdout
    return [line.split("[")[1].split("]")[0] for line in found.splitlines() if "(NEEDED)" in line]


def unneeded(libraries: Iterable[Path], roots: Iterable[Path]) -> list[Path]:
    """Of some libraries, those that neither the roots nor any library that they need ask for."""
    candidates, waiting = list(libraries), list(roots)
    by_name = {path.name: path for path in candidates}
    kept: set[Path] = set()
    while waiting:
        path = waiting.pop()
        if path in kept:
            continue
        kept.add(path)
        names = [path.readlink().name] if path.is_symlink() else needed(path)
        waiting += [by_name[name] for name in names if name in by_name]
    return [path for path in candidates if path not in kept]


def unwanted_solvers(casadi: Path) -> list[Path]:
    """CasADi's libraries that neither it nor a kept plugin asks for."""
    everything = list(casadi.glob("*.so*"))
    asked_for = (*(f"libcasadi_{name}" for name in KEPT_PLUGINS), "_casadi.so")
    return unneeded(everything, [path for path in everything if path.name.startswith(asked_for)])


def unneeded_libraries(folder: Path) -> list[Path]:
    """Libraries beside Pinocchio and Pillow that no module of theirs asks for."""
    found: list[Path] = []
    for libraries, modules in (
        ("cmeel.prefix/lib", "cmeel.prefix/lib/python3*/**/*.so"),
        ("pillow.libs", "PIL/*.so"),
    ):
        found += unneeded(folder.joinpath(libraries).glob("*.so*"), list(folder.glob(modules)))
    return found


def strip(folder: Path) -> None:
    """Take the debugging symbols out of all libraries but those that auditwheel has rewritten."""
    for path in folder.rglob("*.so*"):
        if path.is_file() and not path.is_symlink() and not path.parent.name.endswith(".libs"):
            with path.open("rb") as file:
                if file.read(4) != b"\x7fELF":
                    continue
            subprocess.run(["strip", "--strip-unneeded", str(path)], check=True)


def report(what: str, saved: int) -> None:
    """One line of the table."""
    print(f"{saved / MEGABYTE:8.1f} MB  {what}")


def main(environment: Path) -> None:
    """Make an environment slim."""
    (folder,) = environment.glob("lib/python3*/site-packages")
    before = weight([folder])
    for what, patterns in GROUPS.items():
        found = [path for pattern in patterns for path in folder.glob(pattern)]
        found = [path for path in found if path.name not in KEPT_LEXERS or path.parent.name != "lexers"]
        everything = set(found)
        found = [path for path in found if everything.isdisjoint(path.parents)]
        report(what, weight(found))
        remove(found)
    robots = folder / ROBOTS
    others = unused_descriptions(robots)
    report("descriptions of other robots, and what is only drawn", weight(others))
    remove(others)
    for what, action in (
        ("second and third copies of libraries", lambda: link_copies(folder)),
        ("solvers that CasADi brings and nobody calls", lambda: remove(unwanted_solvers(folder / "casadi"))),
        ("libraries that nobody asks for", lambda: remove(unneeded_libraries(folder))),
        ("debugging symbols", lambda: strip(folder)),
    ):
        then = weight([folder])
        action()
        report(what, then - weight([folder]))
    report("left", weight([folder]))
    report("before", before)
    sizes = sorted(((weight([path]), path.name) for path in folder.iterdir()), reverse=True)
    for size, name in sizes[:16]:
        report(f"  {name}", size)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
