"""Take out of a developer's environment what weighs much and nothing opens: `slim_environment.py ENVIRONMENT`.

Headers and build files, descriptions of robots that are not used, pygame's documentation, examples and tests, and
second copies of libraries, which become links. What it does not find is gone already. The container's image goes
further: docker/slim.py.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "docker"))
from slim import GROUPS, ROBOTS, link_copies, remove, unused_descriptions

SUFFIXES = ("**/*.pyi", "**/*.h", "**/*.hpp", "**/*.pxd", "**/*.la")
"""Stay: type checkers and compilers read them, and they weigh little."""

PYGAMES_OWN = ("pygame/docs", "pygame/examples", "pygame/tests")


def slim(environment: Path) -> None:
    """Make an environment lighter."""
    (folder,) = environment.glob("lib/python3*/site-packages")
    for pattern in GROUPS["headers, build files"]:
        if pattern not in SUFFIXES:
            remove(folder.glob(pattern))
    for name in PYGAMES_OWN:
        remove(folder.glob(name))
    robots = folder / ROBOTS
    if robots.is_dir():
        remove(unused_descriptions(robots))
    for name in ("casadi", "cmeel.prefix/lib"):
        if (folder / name).is_dir():
            link_copies(folder / name)


if __name__ == "__main__":
    slim(Path(sys.argv[1]))
